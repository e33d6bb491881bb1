"""The journal: what was appended is read back, whatever the moment of a kill; what is not a journal is refused."""

import errno
import os
import shutil
from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.errors import DiskFullError, JournalError, OtherVersionError
from legpush.history.entries import Acted, Awaited, Entry, Numbered, Observed, Opened, Planned, Queried, Refused
from legpush.history.journal import Journal, read_entries
from legpush.history.journal_file import is_incomplete
from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.stepping import Outcome, Walk
from tests.legpush.examples import PLAN, QUERY, RESET, TRACE, WORLD

OPENED = Opened(protocol=PROTOCOL_VERSION, run="test", seed=3, versions={"legpush": "0.1.0"}, began_unix_s=1.7e9)
ENTRIES: list[Entry] = [
    Queried(query=QUERY),
    Planned(plan=PLAN),
    Numbered(episode=5),
    Acted(motion=RESET, with_trace=True),
    Observed(outcome=Outcome(world=WORLD, state_crc=7, trace=TRACE)),
    Acted(motion=Walk(), with_trace=False),
    Refused(reason="no path"),
    Awaited(revision=2),
]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A journal with one entry of each type."""
    path = tmp_path / "episode-0000.journal"
    with Journal(path, OPENED) as journal:
        for entry in ENTRIES:
            journal.append(entry)
    return path


def test_entries_are_read_back_in_order(path: Path) -> None:
    assert list(read_entries(path)) == [OPENED, *ENTRIES]


def test_an_entry_is_on_disk_when_append_returns(tmp_path: Path) -> None:
    with Journal(tmp_path / "j", OPENED) as journal:
        journal.append(ENTRIES[0])
        assert list(read_entries(journal.path)) == [OPENED, ENTRIES[0]]


def test_a_journal_is_continued_where_it_ends(path: Path) -> None:
    with Journal(path, OPENED) as journal:
        journal.append(Numbered(episode=6))
    assert list(read_entries(path)) == [OPENED, *ENTRIES, Numbered(episode=6)]


def test_a_continued_journal_keeps_its_first_beginning(path: Path) -> None:
    later = Opened(protocol=PROTOCOL_VERSION, run="test", seed=3, versions={"legpush": "0.2.0"}, began_unix_s=1.8e9)
    with Journal(path, later) as journal:
        assert journal.opened == OPENED


def test_a_last_entry_cut_off_at_any_byte_is_dropped_and_the_rest_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "j"
    with Journal(path, OPENED) as journal:
        journal.append(ENTRIES[2])
        n_whole = path.stat().st_size
        journal.append(ENTRIES[6])
    whole = path.read_bytes()
    for n_bytes in range(n_whole, len(whole)):
        path.write_bytes(whole[:n_bytes])
        assert list(read_entries(path)) == [OPENED, ENTRIES[2]]
        with Journal(path, OPENED) as journal:
            journal.append(ENTRIES[5])
        assert list(read_entries(path)) == [OPENED, ENTRIES[2], ENTRIES[5]]


def test_cutting_off_an_incomplete_entry_is_logged(path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path.write_bytes(path.read_bytes()[:-3])
    with Journal(path, OPENED):
        assert "the last 37 bytes were damaged and are cut off; it goes on from step 1" in caplog.text


def test_a_changed_byte_anywhere_is_found(path: Path) -> None:
    whole = path.read_bytes()
    for position in range(0, len(whole), 7):
        changed = bytearray(whole)
        changed[position] ^= 0x10
        path.write_bytes(changed)
        with pytest.raises(JournalError, match=r"damaged|not an episode journal"):
            list(read_entries(path))


@pytest.mark.parametrize("content", [b"", b"legpush", b"\x89PNG\r\n\x1a\n" * 20])
def test_a_file_that_is_no_journal_is_refused_and_left_as_it_is(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "j"
    path.write_bytes(content)
    with pytest.raises(JournalError, match="not an episode journal"):
        Journal(path, OPENED)
    assert path.read_bytes() == content


@pytest.mark.parametrize(("field", "value"), [("run", "other"), ("seed", 4)])
def test_a_journal_of_something_else_is_refused(path: Path, field: str, value: object) -> None:
    fields = {"protocol": PROTOCOL_VERSION, "run": "test", "seed": 3, "versions": {}, "began_unix_s": 0.0}
    with pytest.raises(JournalError, match=rf"expected a journal of {field} {value}, got one of"):
        Journal(path, Opened(**{**fields, field: value}))  # type: ignore[arg-type]


def test_a_journal_of_another_protocol_is_of_another_version(path: Path) -> None:
    words = f": other version: expected a journal of protocol version 99, got one of {PROTOCOL_VERSION}; the mission"
    with pytest.raises(OtherVersionError, match=words):
        Journal(path, replace(OPENED, protocol=99))


def test_a_journal_is_written_by_one_process_at_a_time(path: Path) -> None:
    with Journal(path, OPENED), pytest.raises(JournalError, match="in use"):
        Journal(path, OPENED)
    with Journal(path, OPENED) as journal:
        assert journal.opened == OPENED


def test_a_missing_folder_is_made(tmp_path: Path) -> None:
    with Journal(tmp_path / "a" / "b" / "j", OPENED):
        pass
    assert [path.name for path in (tmp_path / "a" / "b").iterdir()] == ["j"]


def test_a_place_where_no_journal_can_be_is_refused(tmp_path: Path) -> None:
    with pytest.raises(JournalError, match="Is a directory"):
        Journal(tmp_path, OPENED)
    with pytest.raises(JournalError, match="No such file"):
        list(read_entries(tmp_path / "missing"))


def test_of_two_processes_that_begin_the_same_journal_one_has_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "j"
    with Journal(path, OPENED) as journal:
        journal.append(ENTRIES[0])
        monkeypatch.setattr(Path, "exists", lambda path: False)
        with pytest.raises(JournalError, match="in use"):
            Journal(path, OPENED)
    assert list(read_entries(path)) == [OPENED, ENTRIES[0]]


def test_a_full_disk_has_an_error_of_its_own_and_leaves_no_half_entry(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = path.read_bytes()
    write = os.write
    n_writes = 0

    def full(file: int, data: bytes) -> int:
        nonlocal n_writes
        n_writes += 1
        if n_writes > 1:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(file, data[:7])

    with Journal(path, OPENED) as journal, monkeypatch.context() as patch:
        patch.setattr(os, "write", full)
        with pytest.raises(DiskFullError, match=r"Expected to write the journal .*No space left on device") as caught:
            journal.append(Numbered(episode=6))
    assert caught.value.exit_code == 5
    assert n_writes == 2
    assert path.read_bytes() == before


def test_entries_are_on_the_disk_when_the_journal_is_closed(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []
    monkeypatch.setattr(os, "fdatasync", lambda file: sizes.append(os.fstat(file).st_size))
    with Journal(path, OPENED) as journal:
        for number in range(100):
            journal.append(Numbered(episode=number))
    assert sizes[-1] == path.stat().st_size
    assert len(sizes) < 10


def test_a_journal_of_another_run_is_not_cut(path: Path) -> None:
    torn = path.read_bytes()[:-3]
    path.write_bytes(torn)
    other = Opened(protocol=PROTOCOL_VERSION, run="other", seed=3, versions={}, began_unix_s=0.0)
    with pytest.raises(JournalError, match="expected a journal of run other"):
        Journal(path, other)
    assert path.read_bytes() == torn


def test_no_space_for_the_original_of_a_torn_journal_is_told_and_it_is_left_as_it_was(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    torn = path.read_bytes()[:-3]
    path.write_bytes(torn)

    def full(source: Path, to: Path) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(shutil, "copyfile", full)
    with pytest.raises(DiskFullError):
        Journal(path, OPENED)
    assert path.read_bytes() == torn
    assert list(path.parent.iterdir()) == [path]


def test_an_entry_that_is_finished_while_it_is_read_is_read_too(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole[:-5])

    def finished_meanwhile(file: int, position: int) -> bool:
        path.write_bytes(whole)
        return is_incomplete(file, position)

    monkeypatch.setattr("legpush.history.journal.is_incomplete", finished_meanwhile)
    assert list(read_entries(path)) == [OPENED, *ENTRIES]
