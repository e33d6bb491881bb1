"""Damaged journals before a mission goes on: a torn end is cut off at once, other damage when it is asked for."""

from pathlib import Path

import pytest

from legpush.errors import JournalError
from legpush.history.entries import Opened, Queried
from legpush.history.journal import Journal, read_entries
from legpush.history.mending import mend, step_back
from legpush.messages.common import PROTOCOL_VERSION
from tests.legpush.examples import QUERY

OPENED = Opened(protocol=PROTOCOL_VERSION, run="test", seed=3, versions={}, began_unix_s=0.0)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "j"
    with Journal(path, OPENED) as journal:
        journal.append(Queried(query=QUERY))
    return path


def test_a_whole_journal_needs_nothing(path: Path) -> None:
    assert mend(path) is None
    with pytest.raises(JournalError, match="got a whole one: nothing to recover"):
        step_back(path)
    assert list(path.parent.iterdir()) == [path]


def test_a_torn_end_is_cut_off_and_the_original_is_kept(path: Path) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole + b"torn")
    done = mend(path)
    assert done == (
        f"{path}: the last 4 bytes were damaged and are cut off; it goes on from step 0, and the original is j.damaged"
    )
    assert path.read_bytes() == whole
    assert mend(path) is None


def test_nothing_can_be_used_without_the_first_entry(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[30] ^= 1
    path.write_bytes(data)
    for use in (mend, step_back):
        with pytest.raises(JournalError, match="entry 0 at byte 16 is damaged, the first one: nothing in it can be us"):
            use(path)
    assert path.read_bytes() == data


def test_a_journal_in_use_is_left_alone(path: Path) -> None:
    with Journal(path, OPENED):
        for use in (mend, step_back):
            with pytest.raises(JournalError, match="in use"):
                use(path)
    assert len(list(read_entries(path))) == 2


def test_a_journal_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(JournalError, match="No such file"):
        mend(tmp_path / "j")
