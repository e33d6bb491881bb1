"""Files that are complete or not there at all: a full disk or a crash leaves the previous one as it was."""

import hashlib
import os
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

from legpush.errors import LegpushError


class DiskError(LegpushError):
    """Something that could not be written; names the file and what is still there of it."""


def write_whole(path: Path, data: bytes) -> None:
    """Write a file beside `path`, onto the disk, and only then put it in its place; `DiskError` where that fails."""
    part = path.with_name(f"{path.name}.part")
    try:
        with part.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        kept = "; the previous one is untouched" if path.exists() else ""
        raise DiskError(f"{path}: expected to write {len(data)} bytes ({error.strerror}){kept}") from error


def replace_folder(folder: Path, fill: Callable[[Path], None]) -> None:
    """Let `fill` make the contents in a folder of their own, and only then put that in the place of `folder`."""
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


def sha256_of(paths: Sequence[Path]) -> str:
    """Of a recording, all parts together."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.read_bytes())
    return digest.hexdigest()
