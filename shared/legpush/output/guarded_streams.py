"""Standard output and standard error that never stop the work, whatever they are connected to.

A pipe may be closed, a disk full, an encoding without the letters, a stream closed from the start. Writing then fails
silently, and a program says at its end what could not be written. So no line of progress costs the work behind it.
"""

import errno
import io
import os
import select
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final, TextIO, cast

from legpush.errors import DISK_FULL, FAILED, FULL

BROKEN_PIPE: Final = 141
"""Exit code of a program whose reader is gone: 128 and the number of SIGPIPE, as a shell reports it."""
STANDARD: Final = (0, 1, 2)
"""File descriptors of standard input, output and error."""


class _Raw(io.FileIO):
    """A file descriptor that remembers its first error, and drops what is written after it."""

    failure: OSError | None = None

    def write(self, data: Any) -> int:
        """Write what can be written; return the number of bytes, also of dropped ones."""
        if self.failure is None:
            try:
                while (n_written := super().write(data)) is None:
                    select.select([], [self], [])  # the descriptor does not block, so wait until it takes more
            except OSError as error:
                self.failure = error
            else:
                return n_written
        return len(memoryview(data).cast("B"))


@dataclass
class Output:
    """The guarded streams of a program."""

    decides: bool = True
    """Whether an error of standard output becomes the exit code of a program that was successful otherwise. A mission
    has a report, so its exit code stays."""
    _raw: _Raw | None = None
    """Standard output; None if it is not that of the process, such as in a notebook."""
    _flush: Callable[[], None] = field(default=lambda: None)

    def final_code(self, code: int) -> int:
        """Write what is buffered, and return the exit code of a program that has ended with `code`.

        If something could not be written, other than to a closed pipe, a line on standard error says why.
        """
        self._flush()
        failure = None if self._raw is None else self._raw.failure
        if failure is None or not self.decides or code != 0:
            return code
        if failure.errno == errno.EPIPE:
            return BROKEN_PIPE
        sys.stderr.write(f"error: cannot write to standard output ({failure.strerror})\n")
        sys.stderr.flush()
        return DISK_FULL if failure.errno in FULL else FAILED


def with_guarded_output(work: Callable[[Output], int]) -> int:
    """Do the work of a program with guarded streams; return its exit code, or that of an error of standard output.

    A `SystemExit` of the work is raised with that code. Afterwards the streams are those from before.
    """
    _open_closed_descriptors()
    before = sys.stdout, sys.stderr
    output = Output()
    (sys.stdout, output._raw), (sys.stderr, error_raw) = _guarded(sys.stdout, 1), _guarded(sys.stderr, 2)

    def flush() -> None:
        for stream, raw in ((sys.stdout, output._raw), (sys.stderr, error_raw)):
            if raw is not None:
                stream.flush()

    output._flush = flush
    try:
        try:
            return output.final_code(work(output))
        except SystemExit as end:
            code = 0 if end.code is None else end.code
            if isinstance(code, int) and (final := output.final_code(code)) != code:
                raise SystemExit(final) from None
            raise
        finally:
            flush()
    finally:
        sys.stdout, sys.stderr = before


def _open_closed_descriptors() -> None:
    """Connect closed standard descriptors to the null device, so that no file of the work gets their numbers."""
    for descriptor in STANDARD:
        try:
            os.fstat(descriptor)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # the lowest free number is this one


def _guarded(stream: TextIO | None, descriptor: int) -> tuple[TextIO, _Raw | None]:
    """Return a guarded stream in the place of one, and its raw file; a stream elsewhere is returned as it is."""
    if stream is not None and not _is_on(stream, descriptor):
        return stream, None
    raw = _Raw(descriptor, "w", closefd=False)
    if stream is None:
        return io.TextIOWrapper(io.BufferedWriter(raw), encoding="utf-8", errors="replace"), raw
    try:
        stream.flush()
    except OSError as error:
        raw.failure = error
    encoding = cast("io.TextIOWrapper", stream).encoding
    unbuffered = descriptor == 2 or bool(os.environ.get("PYTHONUNBUFFERED")) or raw.isatty()
    text = io.TextIOWrapper(io.BufferedWriter(raw), encoding=encoding, errors="replace", line_buffering=unbuffered)
    return text, raw


def _is_on(stream: TextIO, descriptor: int) -> bool:
    """Return whether a stream writes to a descriptor of this process."""
    try:
        return isinstance(stream, io.TextIOWrapper) and stream.fileno() == descriptor
    except (OSError, ValueError):
        return False
