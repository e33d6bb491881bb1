"""The environment and the common flags of child processes."""

from collections.abc import Mapping
from typing import Final

RECORDED: Final = ("--recorded",)
"""Makes a process keep copies of what it publishes from its start on, for a recorder that comes later."""
ONE_THREAD: Final = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
"""Arrays here are small: more threads only get in each other's way."""


def child_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """What the processes get: what the launcher has, one thread per library, and output as it comes."""
    return {**environment, **ONE_THREAD, "PYTHONUNBUFFERED": "1"}
