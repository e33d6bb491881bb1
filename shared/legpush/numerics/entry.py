"""Gives a process that was started by hand the profile: it becomes itself again, once, with its own arguments."""

import os
import sys

from legpush.numerics.profile import VARIABLE, X86_64_V3, with_profile


def enter_profile() -> None:
    """Start this process again under the profile, unless it is under it already.

    Call it first, and only from the main module of a program, or from a command before its work begins. Nothing happens
    if the environment was made for a profile, or the user asked for `native`; if a debugger or a tracer would lose the
    process; or on a machine that cannot keep the profile. `legpush.numerics.current` then says so.
    """
    if VARIABLE in os.environ or is_watched() or not sys.executable or not sys.orig_argv:
        return
    environment = with_profile(os.environ)
    if environment.get(VARIABLE) != X86_64_V3:
        return
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.flush()
    os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)  # noqa: S606 - no shell is wanted


def is_watched() -> bool:
    """Return whether a debugger, a tracer or a coverage tool follows this process."""
    if sys.gettrace() is not None:
        return True
    monitoring = getattr(sys, "monitoring", None)  # from Python 3.12 on
    return monitoring is not None and any(monitoring.get_tool(number) is not None for number in range(6))
