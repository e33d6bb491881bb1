"""Writes files completely or not at all: after a full disk or a crash, the previous file is unchanged."""

import hashlib
import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import Final

from legpush.errors import LegpushError

SPACE: Final = 65536
"""Number of bytes for which `require_space` looks."""
PRIVATE_FILE: Final = 0o600
"""Mode of a file that can hold a secret of the user: a command line, a log, a recording."""
PRIVATE_FOLDER: Final = 0o700
"""Mode of a folder with such files, where the user has not chosen the folder."""


class DiskError(LegpushError):
    """A file that could not be written; names the file, and says whether the previous one is kept."""


def write_whole(path: Path, data: bytes, *, private: bool = False) -> None:
    """Write a file beside `path`, onto the disk, and only then put it in its place.

    A `private` file can be read by its user alone.

    Raises:
        DiskError: The file cannot be written; the previous one is unchanged.
    """
    part = path.with_name(f"{path.name}.part")
    try:
        with open(part, "wb", opener=private_opener if private else None) as file:
            if private:
                os.fchmod(file.fileno(), PRIVATE_FILE)
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        kept = "; the previous one is untouched" if path.exists() else ""
        raise DiskError(f"{path}: expected to write {len(data)} bytes ({error.strerror}){kept}") from error
    finally:
        part.unlink(missing_ok=True)


def private_opener(path: str, flags: int) -> int:
    """Open a file as `open` does with this as its `opener`; a file that is made now can be read by its user alone."""
    return os.open(path, flags, PRIVATE_FILE)


def make_folder(folder: Path, *, private: bool) -> None:
    """Make a folder and its parents if they are missing.

    Only the user can enter a `private` one. A folder that is there keeps its mode.

    Raises:
        OSError: It cannot be made.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(mode=PRIVATE_FOLDER if private else 0o777, exist_ok=True)


@contextmanager
def new_file(path: Path, *, private: bool = False) -> Iterator[Path]:
    """Yield a path to write to; on exit, put the file there onto the disk and name it `path`, in one step.

    After an error within the context there is no file. An existing file is never replaced. A `private` file can be read
    by its user alone.

    Raises:
        OSError: The file cannot be made; `FileExistsError` if another one has the name.
    """
    with TemporaryDirectory(prefix=f".{path.name}-", dir=path.absolute().parent) as folder:
        scratch = Path(folder) / f"whole{path.suffix}"
        yield scratch
        with scratch.open("rb") as file:
            if private:
                os.fchmod(file.fileno(), PRIVATE_FILE)
            os.fsync(file.fileno())
        _name(scratch, path)


def _name(scratch: Path, path: Path) -> None:
    """Name a file by a link, which fails if the name is taken; without links, check the name just before."""
    try:
        os.link(scratch, path)
    except FileExistsError:
        raise
    except OSError:
        if os.path.lexists(path):
            raise
        scratch.rename(path)


def replace_folder(folder: Path, fill: Callable[[Path], None]) -> None:
    """Let `fill` write into a new folder, and only then put that in the place of `folder`.

    Raises:
        DiskError: The folder cannot be written; the previous one is kept.
    """
    part, old = (folder.with_name(f"{folder.name}.{suffix}") for suffix in ("part", "old"))
    try:
        for leftover in (part, old):
            shutil.rmtree(leftover, ignore_errors=True)
        part.mkdir(parents=True)
        fill(part)
        if folder.exists():
            folder.replace(old)
        part.replace(folder)
        shutil.rmtree(old, ignore_errors=True)
    except OSError as error:
        raise DiskError(f"{folder}: expected to write it ({error.strerror}); what was there is kept") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)
        if old.exists() and not folder.exists():
            old.replace(folder)


def require_space(folder: Path) -> None:
    """Check that there is some space left for files in a folder.

    Raises:
        DiskError: There is none, or nothing can be written there.
    """
    try:
        with TemporaryFile(dir=folder) as file:
            file.write(bytes(SPACE))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise DiskError(f"{folder}: expected space for {SPACE} bytes ({error.strerror})") from error


def next_file(file: Path) -> Path:
    """Return a file that continues this one: `m-2.mcap` after `m.mcap`, or the first number that is free."""
    stem, _, number = file.stem.rpartition("-")
    first = file.with_name(f"{stem}{file.suffix}")
    if not (number.isdecimal() and first.exists()):
        first = file
    names = (f"{first.stem}-{number}{first.suffix}" for number in count(2))
    return next(path for path in map(first.with_name, names) if path != file and not path.exists())


def sha256_of(paths: Sequence[Path]) -> str:
    """Return the SHA-256 of files, such as all parts of a recording, as if they were one file."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.read_bytes())
    return digest.hexdigest()
