"""Errors that legpush reports to its user as one sentence, without a traceback."""

import errno
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, ClassVar, Final, Literal

FAILED: Final = 3
"""The exit code of a process with a fault of its own, and of a program whose process or peer failed."""
NO_OPENGL: Final = 4
"""Exit code of a program that cannot draw because no OpenGL library can be used."""
DISK_FULL: Final = 5
"""Exit code of a program that could not go on because the disk is full; with more space it can go on."""
FULL: Final = (errno.ENOSPC, errno.EDQUOT)
"""Numbers of the system's errors that mean `DISK_FULL`."""
EXHAUSTED: Final = (errno.EMFILE, errno.ENFILE, errno.EIO)
"""Numbers of the system's errors that are no fault of the user's input: too many open files, or a broken device."""
INTERRUPTED: Final = 130
"""Exit code of a program that was interrupted before its work was done."""


class LegpushError(Exception):
    """An error of the user, a peer process or a file; its text has what was expected, what came, and where."""

    exit_code: ClassVar[int] = 3
    """Exit code of the process: 2 for bad input, 3 if a process failed, 5 on a full disk, 130 if interrupted."""

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self) -> tuple[str, ...]:
        """The text, and further lines if it has several parts."""
        return tuple(map(str, self.args))


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
    """A scenario file that cannot be used; names the file, the line and the field of everything that is wrong."""

    exit_code = 2


class EndpointError(LegpushError):
    """An address to which a process cannot listen or connect; names the address."""

    exit_code = 2


class CredentialsError(LegpushError):
    """A certificate, key or access rule with which a process cannot take part; names it, and who refuses it."""

    exit_code = 2


class MessageError(LegpushError):
    """Bytes that are not a valid message; names the path of the first field that is wrong."""

    def __init__(self, text: str, cause: Literal["malformed", "oversize", "not_finite"] = "malformed") -> None:
        super().__init__(text)
        self.cause = cause


class PeerError(LegpushError):
    """A peer process that is missing or frozen, refuses, or gives another answer; names the peer and the step."""


class PeerGoneError(PeerError):
    """A peer process that is gone, while another one could be asked in its place."""


class BadAnswerError(PeerError):
    """An answer of planner or simulator that cannot be used; the same question gets it again; names the answer."""

    exit_code = 2


class DivergedError(PeerError):
    """A simulator that led equal motions to another state than before; names the step and both states."""


class JournalError(LegpushError):
    """An episode journal that does not belong to this run or contradicts it; names the entry."""

    exit_code = 2


class DiskFullError(LegpushError):
    """A file that cannot be written or go on because the disk is full; what was written before is whole."""

    exit_code = DISK_FULL


class RecordingError(LegpushError):
    """A recording that cannot be read, written or used; names the file and the place in it."""

    exit_code = 2


class OtherVersionError(LegpushError):
    """A recording, journal, training or study of another version, which computes otherwise; names both versions."""

    exit_code = 2


class MotionError(LegpushError):
    """A motion that the simulator cannot carry out in its present state, such as walking before a path was given."""

    exit_code = 2


class BrokenEpisodeError(LegpushError):
    """A motion at which the simulator failed: the episode is broken, and only a reset goes on; names the failure."""

    exit_code = 2


class StopRequestedError(LegpushError):
    """The user or the launcher asked this process to stop before its work was done."""

    exit_code = 130


def exit_code_of(work: Callable[[], int]) -> int:
    """Do the work and return its exit code, or that of its error, which becomes one line on standard error.

    A full disk has an exit code of its own, whatever could not be written. An error of the system that names a file is
    bad input, or a fault where the machine is out of something. An error that an interrupt caused is not printed: a
    library in C++ that is interrupted while it is imported says that its initialization failed. Any other error is
    raised.
    """
    try:
        return work()
    except (LegpushError, OSError) as error:
        if is_interrupt(error):
            return code_of(error)
        if isinstance(error, OSError) and error.filename is None and not is_disk_full(error):
            raise
        lines = error.lines() if isinstance(error, LegpushError) else (_of_system(error),)
        with suppress(OSError):  # on a full disk the log is full, too: the exit code says what happened
            sys.stderr.write("error: " + "\n       ".join(map(one_line, lines)) + "\n")
        return code_of(error)


def code_of(error: BaseException) -> int:
    """Return the exit code of a program that ends with this error."""
    if is_disk_full(error):
        return DISK_FULL
    if is_interrupt(error):
        return INTERRUPTED
    if isinstance(error, OSError):
        return FAILED if error.errno in EXHAUSTED else ConfigError.exit_code
    return error.exit_code if isinstance(error, LegpushError) else 1


def _of_system(error: OSError) -> str:
    """Return the text of an error of the system, with its file first."""
    return str(error) if error.filename is None else f"{error.filename}: {error.strerror}"


def is_disk_full(error: BaseException) -> bool:
    """Whether the error, or one that caused it, is that of a full disk or an exhausted quota."""
    return any(
        isinstance(cause, DiskFullError) or (isinstance(cause, OSError) and cause.errno in FULL)
        for cause in _with_causes(error)
    )


def is_interrupt(error: BaseException) -> bool:
    """Whether the error, or one that caused it, is an interrupt."""
    return any(isinstance(cause, KeyboardInterrupt) for cause in _with_causes(error))


def _with_causes(error: BaseException) -> Iterator[BaseException]:
    """Yield the error and those that it was raised from."""
    cause: BaseException | None = error
    while cause is not None:
        yield cause
        cause = cause.__cause__


def printable(text: str) -> str:
    """Return the text with control characters but line breaks as escape sequences, so that no terminal obeys them."""
    return "\n".join(map(one_line, text.split("\n")))


def one_line(text: str) -> str:
    """Return the text with line breaks and other control characters as escape sequences."""
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)
