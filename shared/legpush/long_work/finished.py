"""Keeps the finished parts of long work in a file, so that the same command goes on after an interrupt or a kill."""

import json
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from legpush.errors import ConfigError


class FinishedParts:
    """The finished parts by name; their values are what JSON can express, and infinite numbers.

    The file has one line for each part, after a first line that says what the work is. A line that a killed program
    left unfinished is cut off.
    """

    def __init__(self, path: Path, file: BinaryIO, parts: dict[str, Any]) -> None:
        """Use `open_finished`."""
        self.path = path
        self.parts: Mapping[str, Any] = parts
        self._file = file
        self._parts = parts
        self._lock = threading.Lock()

    def keep(self, name: str, value: Any) -> None:
        """Add a part; it is in the file when this returns. Any thread may call it."""
        with self._lock:
            self._file.write(_line([name, value]))
            self._file.flush()
            self._parts[name] = value


@contextmanager
def open_finished(path: Path, work: Mapping[str, Any]) -> Iterator[FinishedParts]:
    """Open the file of the finished parts of this work, or begin it.

    The file is removed on exit if it has no parts, and otherwise kept until the program that has the whole result
    removes it.

    Raises:
        ConfigError: The file is none of these, or has parts of other work; names the first difference.
        OSError: It cannot be read or written.
    """
    with path.open("a+b") as file:
        file.seek(0)
        parts = _read(file, dict(work), path)
        try:
            yield FinishedParts(path, file, parts)
        finally:
            if not parts:
                path.unlink(missing_ok=True)


def _read(file: BinaryIO, work: dict[str, Any], path: Path) -> dict[str, Any]:
    """Return the parts, and leave the file at its end, behind its last whole line."""
    data = file.read()
    end = data.rfind(b"\n") + 1
    if end < len(data):
        file.truncate(end)
    if not end:
        file.write(_line(work))
        file.flush()
        return {}
    head, *lines = data[:end].splitlines()
    try:
        before, rows = json.loads(head), [json.loads(line) for line in lines]
        parts, before = {str(name): value for name, value in rows}, dict(before)
    except (ValueError, TypeError) as error:
        raise ConfigError(f"{path}: expected finished parts of earlier work, got other lines ({error})") from error
    for name in dict.fromkeys((*work, *before)):
        if before.get(name) != json.loads(json.dumps(work.get(name))):
            raise ConfigError(
                f"{path}: expected finished parts of the same work, got some with another {name}; remove the file to "
                "begin again"
            )
    return parts


def _line(value: Any) -> bytes:
    return f"{json.dumps(value)}\n".encode()
