"""`legpush record` without flags, in a second terminal, while something launched goes on."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.runs.live_runs import RUN_FILE
from tests.legpush.fakes import eventually

CLI = ["-P", "-c", "import sys; from legpush.cli import main; sys.exit(main())"]
Start = Callable[..., subprocess.Popen[str]]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Starts `legpush` with a temporary directory of the test's own; none is left behind."""
    started: list[subprocess.Popen[str]] = []
    temporary = tmp_path / "t"
    temporary.mkdir()
    environment = {name: value for name, value in os.environ.items() if name != "LEGPUSH_RUN"}

    def legpush(*arguments: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, *CLI, *arguments],
            cwd=tmp_path,
            env={**environment, "TMPDIR": str(temporary)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process

    yield legpush
    for process in started:
        process.kill()
        process.communicate()


def n_live(folder: Path) -> int:
    return len(list(folder.glob(f"t/legpush-*/{RUN_FILE}")))


def children(pid: int, word: str) -> list[psutil.Process]:
    """The processes with this word in their command line that a process has started, zombies left out."""
    found = []
    for each in psutil.Process(pid).children():
        with suppress(psutil.NoSuchProcess, psutil.ZombieProcess):
            found += [each] if word in each.cmdline() else []
    return found


def end(process: subprocess.Popen[str]) -> tuple[int, str]:
    """Exit code and output of a process that is asked to end."""
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60.0)
    return process.returncode, out + err


def n_said(recording: Recording, role: str) -> int:
    """Of the lockstep."""
    return sum(m.origin.role == role and not m.topic.startswith("tap/") for m in recording.messages)


def test_a_mission_that_runs_is_recorded(start: Start, tmp_path: Path) -> None:
    file = tmp_path / "mission.mcap"
    mission = start("run", "push", "--no-video", "--out", "r1")
    planners: list[psutil.Process] = []

    def has_planner() -> bool:
        planners.extend(children(mission.pid, "planner_proc"))
        return planners != []

    assert eventually(has_planner, 30.0)
    planners[0].suspend()  # so that the mission is not over before the recorder has started
    assert eventually(lambda: n_live(tmp_path) == 1, 30.0)
    recorder = start("record", file.name)
    assert recorder.stderr is not None
    before = ""
    for line in recorder.stderr:
        before += line
        if "recording to" in line:
            break
    planners[0].resume()
    out, err = mission.communicate(timeout=120.0)
    assert mission.returncode == 0, out + err
    assert n_live(tmp_path) == 0
    code, after = end(recorder)
    said = before + after
    assert code == 0, said
    assert f"recording run r1 (run, in {tmp_path}/r1)" in said
    recording = read_recording([file])
    assert all(n_said(recording, role) > 0 for role in ("planner", "sim", "agent")), said
    assert recording.about["run"] == "r1"


def test_simulators_of_an_evaluation_are_recorded_from_the_middle_on_and_when_they_are_replaced(
    start: Start, tmp_path: Path
) -> None:
    first, late = tmp_path / "first.mcap", tmp_path / "late.mcap"
    evaluation = start("evaluate", "scripted", "--episodes", "500", "--simulators", "2", "--out", "e1")
    assert eventually(lambda: n_live(tmp_path) == 1, 30.0)
    early = start("record", first.name, "--topics", "sim/*", "--duration", "3")
    early.communicate(timeout=60.0)
    assert n_said(read_recording([first]), "sim") > 0
    recorder = start("record", late.name)
    assert eventually(lambda: late.exists() and late.stat().st_size > 200_000, 30.0)
    (victim,) = children(evaluation.pid, "sim1")
    victim.kill()
    assert eventually(lambda: any(each != victim for each in children(evaluation.pid, "sim1")), 60.0)
    size = late.stat().st_size
    assert eventually(lambda: late.stat().st_size > size + 1_000_000, 60.0)
    code, said = end(evaluation)
    assert code == 130, said
    code, said = end(recorder)
    assert "recording run e1 (evaluate, in " in said
    assert code == 1, said
    recording = read_recording([late])
    simulators = {m.origin.incarnation: m.origin.name for m in recording.messages if m.origin.role == "sim"}
    assert sorted(simulators.values()) == ["sim0", "sim1", "sim1"]
    assert n_said(recording, "agent") > 0
    killed, replaced = (incarnation for incarnation, name in simulators.items() if name == "sim1")
    notes = recording.completeness["notes"].splitlines()
    losses = [note for note in notes if not note.endswith("before the recording began")]
    assert any("did not say farewell" in note for note in losses)
    assert all(killed in note for note in losses), said
    assert any(re.search(r"/action of agent main .*: [1-9]\d* messages before", note) for note in notes)
    assert not any(replaced in note for note in notes), said


def test_of_several_runs_one_has_to_be_named(start: Start, tmp_path: Path) -> None:
    for name in ("e1", "e2"):
        start("evaluate", "scripted", "--episodes", "500", "--simulators", "1", "--out", name)
    assert eventually(lambda: n_live(tmp_path) == 2, 30.0)
    refused = start("record", "no.mcap")
    out, err = refused.communicate(timeout=60.0)
    assert (refused.returncode, out) == (2, "")
    assert err.startswith("error: Expected --run with the name or folder of one of the live runs: ")
    assert f"e1 (evaluate, in {tmp_path}/e1)" in err
    assert f"e2 (evaluate, in {tmp_path}/e2)" in err
    assert not (tmp_path / "no.mcap").exists()
    recorder = start("record", "yes.mcap", "--run", "e2", "--duration", "3")
    out, err = recorder.communicate(timeout=60.0)
    assert recorder.returncode == 0, out + err
    recording = read_recording([tmp_path / "yes.mcap"])
    assert recording.about["run"] == "e2"
    assert n_said(recording, "sim") > 0
