"""Checks the flags that several commands have."""

import os
import shutil
from pathlib import Path
from tempfile import TemporaryFile

from legpush.errors import ConfigError, DiskFullError, is_disk_full
from legpush.options.formats import PICTURES


def require_writable_folder(folder: Path, flag: str) -> None:
    """Check that files can be made in a folder, or that the folder can be made; nothing is left behind.

    Raises:
        ConfigError: It is none, or nothing can be written to it.
    """
    there = folder.absolute()
    while not os.path.lexists(there):
        there = there.parent
    _try_to_write(there, folder, f"a folder that can be written to for {flag}")


def require_picture_ending(path: Path, flag: str) -> None:
    """Check that a file has the ending of a picture.

    Raises:
        ConfigError: It has another one.
    """
    if path.suffix.lower() not in PICTURES:
        raise ConfigError(f"Expected a file that ends in {', '.join(PICTURES)} for {flag}, got {path}")


def require_new_file(path: Path, flag: str) -> None:
    """Check that a file can be made.

    Raises:
        ConfigError: The file exists, or its folder does not exist or cannot be written to.
    """
    if os.path.lexists(path) or not path.absolute().parent.is_dir():
        raise ConfigError(f"Expected a new file in an existing folder for {flag}, got {path}")
    require_writable_file(path, flag)


def require_writable_file(path: Path, flag: str) -> None:
    """Check that a file can be made in its folder, or replaced; nothing is left behind.

    Raises:
        ConfigError: Its folder does not exist or cannot be written to, or something else has its name.
    """
    folder = path.absolute().parent
    if not folder.is_dir() or (os.path.lexists(path) and not path.is_file()):
        raise ConfigError(f"Expected a file in an existing folder for {flag}, got {path}")
    _try_to_write(folder, path, f"a file in a folder that can be written to for {flag}")


def _try_to_write(folder: Path, path: Path, expected: str) -> None:
    """Make a file without a name in the folder.

    Raises:
        ConfigError: It cannot be made.
        DiskFullError: The disk is full.
    """
    try:
        with TemporaryFile(dir=folder):
            pass
    except OSError as error:
        if is_disk_full(error):
            raise DiskFullError(f"{path}: expected space for files ({error.strerror})") from error
        where = "" if folder == path.absolute() else f": {folder}"
        raise ConfigError(f"Expected {expected}, got {path} ({error.strerror}{where})") from error


def program_path(name: str) -> str:
    """Return the absolute path of a planner's program, given by name or path.

    Raises:
        ConfigError: No such program is found.
    """
    program = shutil.which(name)
    if program is None:
        raise ConfigError(f"Expected a planner's command that begins with a program, got {name!r}, which is not one")
    return os.path.abspath(program)
