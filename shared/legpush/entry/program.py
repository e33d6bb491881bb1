"""Runs the `main` of a module as the program of this process."""

import sys
import traceback
from contextlib import suppress
from importlib import import_module

from legpush.entry.interrupts import Interrupts, are_handled, hold, release
from legpush.errors import FAILED, INTERRUPTED
from legpush.numerics.entry import enter_profile


def enter_profile_quietly() -> None:
    """Start this process again under the numerics profile, unless it is under it already.

    If its signals are handled, they wait until the new program handles them.
    """
    if are_handled():
        hold()
    enter_profile()
    release()


def run_main(module: str, *arguments: str, profile: bool = False) -> int:
    """Import the module, call its `main` with the arguments, and return the exit code.

    With `profile`, the process first starts itself again under the numerics profile, unless it is under it already. An
    error that no part of the program has explained is a fault: its traceback is printed, and the exit code is 3,
    because 1 would mean that the work was done without success.
    """
    interrupts, code = Interrupts(), FAILED
    interrupts.leave()
    if profile:
        enter_profile_quietly()
    main = import_module(module).main
    interrupts.interrupt()
    try:
        code = main(*arguments)
    except KeyboardInterrupt:
        code = INTERRUPTED
    except SystemExit as end:
        if interrupts.came:
            code = INTERRUPTED
        else:
            code = end.code if isinstance(end.code, int) else FAILED if end.code else 0
            if isinstance(end.code, str):
                sys.stderr.write(f"{end.code}\n")
    except Exception:  # noqa: BLE001 - an interrupt within a library becomes any error, and the rest is a fault
        if interrupts.came:
            code = INTERRUPTED
        else:
            traceback.print_exc()
    finally:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                with suppress(OSError, ValueError):  # the end of Python tells of it
                    stream.flush()
        interrupts.leave(code)
    return code
