"""`legpush recover` of a recording and of the folder of a run."""

from pathlib import Path

import pytest

from legpush.errors import ConfigError
from legpush.history.entries import Queried
from legpush.history.journal import Journal, read_entries
from legpush.launch.recover import run_recover
from legpush.options.recordings import RecoverOptions
from legpush.recording.mcap_file.reader import read_recording
from legpush.runs.folder import COMMAND_FILE, LOGS
from tests.legpush.examples import QUERY
from tests.legpush.fakes import opened
from tests.legpush.recording.recordings import a_recording


def a_damaged_run(folder: Path) -> Path:
    """A journal of three entries, the second damaged."""
    path = folder / "episode-0000.journal"
    ends: list[int] = []
    with Journal(path, opened()) as journal:
        for _ in range(2):
            ends.append(path.stat().st_size)
            journal.append(Queried(query=QUERY))
    data = bytearray(path.read_bytes())
    data[ends[0] + 20] ^= 1
    path.write_bytes(data)
    return path


def test_a_damaged_run_goes_back_before_its_damage_and_is_told_how_to_go_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = a_damaged_run(tmp_path)
    (tmp_path / LOGS).mkdir()
    (tmp_path / LOGS / COMMAND_FILE).write_text("legpush run here\n")
    assert run_recover(RecoverOptions(file=tmp_path)) == 0
    said = capsys.readouterr().out.splitlines()
    assert "it goes on from step 0, and the original is episode-0000.journal.damaged" in said[0]
    assert said[1] == "to go on: legpush run here"
    assert list(read_entries(path)) == [opened()]


def test_without_a_command_in_the_folder_its_flags_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a_damaged_run(tmp_path)
    run_recover(RecoverOptions(file=tmp_path))
    words = f"to go on: the command that began the mission, with --out {tmp_path} and --seed 3"
    assert words in capsys.readouterr().out


def test_a_folder_that_is_not_of_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="Expected a recording, or the folder of a run with a journal in it"):
        run_recover(RecoverOptions(file=tmp_path))


def test_a_recording_gets_a_new_file_beside_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = a_recording(tmp_path / "a.mcap")
    path.write_bytes(path.read_bytes()[:-100])
    assert run_recover(RecoverOptions(file=path)) == 0
    n_messages = len(read_recording([tmp_path / "a-recovered.mcap"]).messages)
    assert f"wrote {tmp_path}/a-recovered.mcap: {n_messages} messages" in capsys.readouterr().out
