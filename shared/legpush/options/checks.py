"""Checks the flags that several commands have."""

import os
import shutil
from pathlib import Path
from tempfile import TemporaryFile

from legpush.errors import ConfigError, DiskFullError, is_disk_full


def require_writable_folder(folder: Path, flag: str) -> None:
    """Check that files can be made in a folder, or that the folder can be made; nothing is left behind.

    Raises:
        ConfigError: It is none, or nothing can be written to it.
    """
    there = folder.absolute()
    while not os.path.lexists(there):
        there = there.parent
    try:
        with TemporaryFile(dir=there):
            pass
    except OSError as error:
        if is_disk_full(error):
            raise DiskFullError(f"{folder}: expected space for files ({error.strerror})") from error
        where = "" if there == folder.absolute() else f": {there}"
        raise ConfigError(
            f"Expected a folder that can be written to for {flag}, got {folder} ({error.strerror}{where})"
        ) from error


def require_new_file(path: Path, flag: str) -> None:
    """Check that a file can be made.

    Raises:
        ConfigError: The file exists, or its folder does not exist or cannot be written to.
    """
    folder = path.absolute().parent
    if os.path.lexists(path) or not folder.is_dir() or not os.access(folder, os.W_OK):
        raise ConfigError(f"Expected a new file in an existing folder for {flag}, got {path}")


def program_path(name: str) -> str:
    """Return the absolute path of a planner's program, given by name or path.

    Raises:
        ConfigError: No such program is found.
    """
    program = shutil.which(name)
    if program is None:
        raise ConfigError(f"Expected a planner's command that begins with a program, got {name!r}, which is not one")
    return os.path.abspath(program)
