"""Temporary folders, and how those of killed processes are cleared."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from legpush.runs.temporary import OWNER_FILE, clear_abandoned, temporary_folder

OWNER = """
import os, signal
from legpush.runs.temporary import temporary_folder
with temporary_folder("killed-") as folder:
    (folder / "deep").mkdir()
    (folder / "deep" / "file").write_text("x")
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A temporary directory of its own."""
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return tmp_path


def kill_an_owner() -> None:
    assert subprocess.run([sys.executable, "-c", OWNER], check=False).returncode < 0


def test_a_folder_is_private_and_ends_with_its_context(temporary: Path) -> None:
    with temporary_folder("a-") as folder:
        assert (folder.parent, folder.stat().st_mode & 0o777) == (temporary, 0o700)
        assert folder.name.startswith("legpush-a-")
        clear_abandoned()
        assert folder.exists()
    assert list(temporary.iterdir()) == []


def test_the_folder_of_a_killed_process_is_cleared_and_seen_before(temporary: Path) -> None:
    kill_an_owner()
    (left,) = temporary.iterdir()
    seen: list[tuple[Path, bool]] = []
    clear_abandoned(lambda folder: seen.append((folder, (folder / "deep" / "file").exists())))
    assert seen == [(left, True)]
    assert list(temporary.iterdir()) == []


@pytest.mark.parametrize("left_alone", ["without an owner file", "of others", "a link", "with a link as owner file"])
def test_what_is_not_known_to_be_abandoned_is_left_alone(temporary: Path, left_alone: str) -> None:
    kill_an_owner()
    (folder,) = temporary.iterdir()
    match left_alone:
        case "without an owner file":
            (folder / OWNER_FILE).unlink()
        case "of others":
            folder.chmod(0o755)
        case "a link":
            folder.rename(temporary / "moved")
            folder.symlink_to(temporary / "moved")
        case "with a link as owner file":
            (folder / OWNER_FILE).rename(folder / "owner")
            (folder / OWNER_FILE).symlink_to(folder / "owner")
    clear_abandoned()
    assert (folder / "deep" / "file").exists()
    assert os.listdir(temporary)
