"""What cannot be written is told in one line before the work begins, by every command that writes."""

import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

from tests.system.commands import LEGPUSH, RUN, STUDY, STUDY_FILE
from tests.system.conftest import RecordedMission

OUT: Final = "OUT"
RECORDING: Final = "RECORDING"
COMMANDS: Final = {
    "run": ("run", "push", "--out", OUT),
    "run --record": ("run", "push", "--record", f"{OUT}.mcap"),
    "train": ("train", "--simulators", "1", "--out", OUT),
    "evaluate": ("evaluate", "scripted", "--out", OUT),
    "evaluate --record": ("evaluate", "scripted", "--record", f"{OUT}.mcap"),
    "calibrate": ("calibrate", "--out", f"{OUT}.json"),
    "plan-check": ("plan-check", "--out", f"{OUT}.json", "--", sys.executable, "-m", "planner_proc"),
    "scenarios copy": ("scenarios", "copy", "default", f"{OUT}.toml"),
    "scenarios random": ("scenarios", "random", f"{OUT}.toml"),
    "map show": ("map", "push", "--out", f"{OUT}.png"),
    "policy export": ("policy", "export", "variable", "--out", OUT),
    "record": ("record", f"{OUT}.mcap", "--connect", "unixsock-stream/nowhere.sock"),
    "recover": ("recover", RECORDING, "--out", f"{OUT}.mcap"),
    "replay": ("replay", RECORDING, "--as", "planner", "--out", OUT),
    "branch": ("branch", RECORDING, "--at", "0:2", "--policy", "scripted", "--out", OUT),
    "branch --record": ("branch", RECORDING, "--at", "0:2", "--policy", "scripted", "--record", f"{OUT}.mcap"),
    "export": ("export", RECORDING, "--out", f"{OUT}.csv"),
    "study merge": ("study", "merge", STUDY, "--out", OUT),
    "study table --csv": ("study", "table", STUDY, "--csv", f"{OUT}.csv"),
    "study table --plot": ("study", "table", STUDY, "--plot", f"{OUT}.png"),
    "bench soak": ("bench", "soak", "--cells", "kill-sim-walking", "--out", OUT),
    "secure init": ("secure", "init", OUT),
    "examples copy": ("examples", "copy", OUT),
    "compare": ("compare", "variable", "--out", OUT),
    "curves": ("curves", "variable", "--out", f"{OUT}.png"),
    "tune": ("tune", "--trials", "1", "--out", OUT),
    "picture": ("picture", RUN, "--out", f"{OUT}.svg"),
    "study run": ("study", "run", "study.toml", "--out", OUT),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_what_cannot_be_written_is_refused_before_the_work(
    name: str, tmp_path: Path, push_mission: RecordedMission, short_study: Path
) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "study.toml").write_text(STUDY_FILE)
    # Even root cannot make files in /proc or below a file.
    folder = "/proc" if len(name) % 2 else "file"
    places = {RECORDING: str(push_mission.file), RUN: str(push_mission.out), STUDY: str(short_study)}
    words = [places.get(word, word) for word in COMMANDS[name]]
    command = [LEGPUSH, *(word.replace(OUT, f"{folder}/new") for word in words)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120)

    assert done.returncode == 2, done.stdout + done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: ")
    assert f"{folder}/new" in line
    assert done.stdout == ""
    assert {path.name for path in tmp_path.iterdir()} == {"file", "study.toml"}
