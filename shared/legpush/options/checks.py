"""Checks the flags that several commands have."""

import os
import shutil
from pathlib import Path

from legpush.errors import ConfigError


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
