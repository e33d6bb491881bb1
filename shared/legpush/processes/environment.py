"""The environment and the common flags of child processes."""

from collections.abc import Mapping
from typing import Final

from legpush.numerics.profile import with_profile

RECORDED: Final = ("--recorded",)
"""Makes a process keep copies of what it publishes from its start on, for a recorder that comes later."""
ONE_THREAD: Final = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
"""Arrays here are small: more threads only get in each other's way."""


def child_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """Return what the processes get: the environment of the launcher under the numerics profile.

    Libraries have one thread each, and output comes as it is written.
    """
    return {**with_profile(environment), **ONE_THREAD, "PYTHONUNBUFFERED": "1"}
