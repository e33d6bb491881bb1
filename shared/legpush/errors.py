"""Errors that legpush reports to its user as one sentence, without a traceback."""

from typing import Any, ClassVar, Final, Literal

NO_OPENGL: Final = 4
"""Exit code of a program that cannot draw because no OpenGL library can be used."""
DISK_FULL: Final = 5
"""Exit code of a program that could not go on because the disk is full; with more space it can go on."""
INTERRUPTED: Final = 130
"""Exit code of a program that was interrupted before its work was done."""


class LegpushError(Exception):
    """An error of the user, a peer process or a file; its text has what was expected, what came, and where."""

    exit_code: ClassVar[int] = 3
    """Exit code of the process: 2 for bad input, 3 if a process failed, 5 on a full disk, 130 if interrupted."""


class ConfigError(LegpushError):
    """A setting that cannot be used; names the setting."""

    exit_code = 2


class PluginError(LegpushError):
    """A planner, simulator, policy or mission that cannot be found or used; names it and its package."""

    exit_code = 2


class PolicyError(LegpushError):
    """A policy that cannot be used, or that raised an exception; names it, and the file."""

    exit_code = 2


class UnsolvableError(LegpushError):
    """A mission for which the planner finds no path."""

    exit_code = 1

    def __init__(self, text: str, run: Any) -> None:
        super().__init__(text)
        self.run = run
        """The `MissionRun` up to this error."""


class ScenarioError(LegpushError):
    """A scenario file that cannot be used; names the file and the field."""

    exit_code = 2


class EndpointError(LegpushError):
    """An address to which a process cannot listen or connect; names the address."""

    exit_code = 2


class MessageError(LegpushError):
    """Bytes that are not a valid message; names the path of the first field that is wrong."""

    def __init__(self, text: str, cause: Literal["malformed", "oversize", "not_finite"] = "malformed") -> None:
        super().__init__(text)
        self.cause = cause


class PeerError(LegpushError):
    """A peer process that is missing or frozen, refuses, or gives another answer; names the peer and the step."""


class DivergedError(PeerError):
    """A simulator that led equal motions to another state than before; names the step and both states."""


class JournalError(LegpushError):
    """An episode journal that does not belong to this run or contradicts it; names the entry."""

    exit_code = 2


class DiskFullError(LegpushError):
    """A journal that cannot go on because the disk is full; what was written before is whole."""

    exit_code = DISK_FULL


class RecordingError(LegpushError):
    """A recording that cannot be read, written or used; names the file and the place in it."""

    exit_code = 2


class MotionError(LegpushError):
    """A motion that the simulator cannot carry out in its present state, such as walking before a path was given."""


class StopRequestedError(LegpushError):
    """The user or the launcher asked this process to stop before its work was done."""

    exit_code = 130
