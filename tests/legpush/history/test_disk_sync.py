"""Writes are brought onto the disk by another thread, and an error of the disk is not lost."""

import os
from pathlib import Path

import pytest

from legpush.history.disk_sync import DiskSync
from tests.legpush.fakes import eventually


def test_a_write_is_synced_soon_and_without_a_write_nothing_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []
    monkeypatch.setattr(os, "fdatasync", synced.append)
    with (tmp_path / "a").open("wb") as file:
        disk = DiskSync(file.fileno(), every_s=0.005)
        disk.start()
        disk.note_write()
        assert eventually(lambda: len(synced) == 1)
        disk.note_write()
        disk.stop()
        assert synced == [file.fileno()] * 2


def test_an_error_of_the_disk_is_raised_at_the_next_write(tmp_path: Path) -> None:
    reading, writing = os.pipe()  # A pipe cannot be synced.
    disk = DiskSync(writing, every_s=0.005)
    disk.start()
    disk.note_write()
    disk.stop()
    os.close(reading)
    os.close(writing)
    with pytest.raises(OSError, match="Invalid argument"):
        disk.note_write()
