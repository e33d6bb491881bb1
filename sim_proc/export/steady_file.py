"""A file for libraries that only log that the disk is full."""

import os
from pathlib import Path
from types import TracebackType


class SteadyFile:
    """Writes until the first error, which it keeps for `check`; what comes after that is dropped."""

    def __init__(self, path: Path) -> None:
        """A new file."""
        self._file = path.open("xb")
        self._error: OSError | None = None
        self._position = self._end = 0
        """As the caller takes it to be."""

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
        """Raise the `OSError` that there was, if any."""
        if self._error is not None:
            raise self._error

    def write(self, data: bytes | bytearray) -> int:
        """All of it, as far as the caller can tell."""
        if self._error is None:
            try:
                self._file.write(data)
            except OSError as error:
                self._error = error
        self._position += len(data)
        self._end = max(self._end, self._position)
        return len(data)

    def flush(self) -> None:
        """Hand over to the system what is kept back."""
        if self._error is None:
            try:
                self._file.flush()
            except OSError as error:
                self._error = error

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to a place; returns it."""
        self._position = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._position, os.SEEK_END: self._end}[whence]
        if self._error is None:
            try:
                self._file.seek(self._position)
            except OSError as error:
                self._error = error
        return self._position
