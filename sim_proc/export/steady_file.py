"""A file for libraries that only log an error when the disk is full."""

import os
from pathlib import Path
from types import TracebackType


class SteadyFile:
    """A file that keeps its first error for `check` and drops everything written after it; a context manager."""

    def __init__(self, path: Path) -> None:
        """Create a file.

        Raises:
            OSError: The file exists, or cannot be created.
        """
        self._file = path.open("xb")
        self._error: OSError | None = None
        self._position = self._end = 0
        """Position and size as they would be without the error."""

    def __enter__(self) -> "SteadyFile":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._file.close()
        except OSError as unwritten:
            self._error = self._error or unwritten
        if error is None:
            self.check()

    def check(self) -> None:
        """Report the first error.

        Raises:
            OSError: Something could not be written.
        """
        if self._error is not None:
            raise self._error

    def write(self, data: bytes | bytearray) -> int:
        """Write data. The caller learns of an error only from `check`."""
        if self._error is None:
            try:
                self._file.write(data)
            except OSError as error:
                self._error = error
        self._position += len(data)
        self._end = max(self._end, self._position)
        return len(data)

    def flush(self) -> None:
        """Hand buffered data over to the operating system."""
        if self._error is None:
            try:
                self._file.flush()
            except OSError as error:
                self._error = error

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to a position and return it."""
        self._position = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._position, os.SEEK_END: self._end}[whence]
        if self._error is None:
            try:
                self._file.seek(self._position)
            except OSError as error:
                self._error = error
        return self._position
