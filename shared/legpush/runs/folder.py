"""The folder of a run: where it is, and that it is ours to write to."""

import fcntl
import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Final

from legpush.errors import ConfigError
from legpush.files import make_folder, new_file
from legpush.scenarios.file import dump_scenario
from legpush.scene.scenario import Scenario

SCENARIO_FILE: Final = "scenario.toml"
LOGS: Final = "logs"
REPORT_FILE: Final = "report.json"
PICTURE_FILE: Final = "mission.png"
VIDEO_FILE: Final = "mission.mp4"
COMMAND_FILE: Final = "command.txt"
"""Name of the file among the logs with the command that goes on."""


def default_folder(scenario: Scenario, seed: int, now: datetime) -> Path:
    """`runs/<timestamp>-<scenario>-seed<N>`, under the working directory."""
    return Path("runs") / f"{now:%Y%m%d-%H%M%S}-{scenario.name}-seed{seed}"


def is_begun(folder: Path) -> bool:
    """Whether a mission began in this folder before, which goes on now."""
    return bool(journals(folder))


def journals(folder: Path) -> list[Path]:
    """Return the journals of a run."""
    return sorted(folder.glob("*.journal"))


def run_name(folder: Path) -> str:
    """Name of a run on the bus: that of its folder, so that a run that goes on is the same run."""
    return re.sub(r"[^A-Za-z0-9_-]", "-", folder.name)[:64] or "run"


@contextmanager
def run_folder(folder: Path, scenario: Scenario, *, private: bool) -> Iterator[None]:
    """Make the folder, with the resolved scenario and a place for logs in it, and keep other launchers out meanwhile.

    The folder of an earlier run of the same scenario may be used again: that run goes on where it ended. Only the user
    can enter a new folder that is `private`, and its logs in any case.

    Raises:
        ConfigError: The folder has something else or a link in it, cannot be written to, or is used by another
            launcher.
    """
    try:
        make_folder(folder, private=private)
        lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    except OSError as error:
        raise _unusable(folder, error) from error
    try:
        _lock(lock, folder)
        require_no_links(folder)
        _fill(folder, dump_scenario(scenario).encode())
        yield
    finally:
        os.close(lock)


def _lock(descriptor: int, folder: Path) -> None:
    """Held until the descriptor is closed, even if by a crash."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise ConfigError(f"{folder}: expected a folder of its own, but another launcher is running in it") from error


def _fill(folder: Path, scenario: bytes) -> None:
    """Write what a run starts from, or see that it is there."""
    file = folder / SCENARIO_FILE
    try:
        if file.exists():
            if file.read_bytes() != scenario:
                raise ConfigError(f"{folder}: expected a new folder, got that of a run of another scenario")
        elif any(folder.iterdir()):
            raise ConfigError(f"{folder}: expected a new or empty folder, or that of a run, got one with other files")
        else:
            with new_file(file) as scratch:
                scratch.write_bytes(scenario)
        make_folder(folder / LOGS, private=True)
    except OSError as error:
        raise _unusable(folder, error) from error


def _unusable(folder: Path, error: OSError) -> ConfigError:
    return ConfigError(f"{folder}: expected a folder that can be written to ({error.strerror})")


@contextmanager
def own_folder(folder: Path) -> Iterator[None]:
    """Keep other programs out of the folder until the context is left.

    Raises:
        ConfigError: Another program is using it, or there is a link in it.
    """
    lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        require_no_links(folder)
        yield
    except BlockingIOError as error:
        raise ConfigError(f"{folder}: expected a folder of its own, but another program is using it") from error
    finally:
        os.close(lock)


def require_no_links(folder: Path) -> None:
    """Check that what is written into a folder from elsewhere stays in it.

    Raises:
        ConfigError: There is a symbolic link that leads out of it, or something else that is neither a file nor a
            folder.
    """
    inside = folder.resolve()
    for place, folders, names in os.walk(folder):
        for path in (Path(place) / name for name in (*folders, *names)):
            kind = path.lstat().st_mode
            if stat.S_ISLNK(kind) and path.is_file() and path.resolve().is_relative_to(inside):
                continue
            if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind)):
                raise ConfigError(
                    f"{path}: expected files and folders alone in the folder of a run, got a device or a link that "
                    "leads elsewhere"
                )
