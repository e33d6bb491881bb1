"""`legpush run` with the real bus and real processes, but small programs in the place of planner, simulator, agent."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import psutil
import pytest
from rich.console import Console

from legpush.launch.process_commands import Place, Programs
from legpush.launch.run import launch_mission
from legpush.messages.common import Role
from legpush.options.run import RunOptions
from legpush.scenarios.file import load_scenario

PROCESS = r"""
import json, os, sys, threading
from dataclasses import dataclass
from pathlib import Path
from legpush.bus.bus import Bus
from legpush.service import ServiceConfig, run_process
from legpush.bus.status import StatusBeacon

role = sys.argv.pop(1)

@dataclass(frozen=True, kw_only=True)
class Config(ServiceConfig):
    out: Path = Path()
    does: str = "ends"

def work(config: Config, bus: Bus, stop: threading.Event) -> int:
    with StatusBeacon(bus) as beacon:
        bus.announce()
        with (config.out / "pids").open("a") as file:
            print(os.getpid(), file=file)
        if role != "agent" or config.does == "waits":
            beacon.publish_status("waiting", 0.5, "for the end")
            while not stop.wait(0.05):  # a signal may wake another thread than this one
                pass
            return 0
        while not {"planner", "sim"} <= {peer.role for peer in bus.liveliness.live()}:
            if stop.wait(0.01):
                return 0
        if config.does == "ends":
            (config.out / "report.json").write_text(json.dumps({"success": True, "box_position_error_m": 0.0123}))
        return 0

sys.exit(run_process(role, Config, work))
"""

HARNESS = r"""
import sys
from pathlib import Path
from rich.console import Console
sys.path.insert(0, sys.argv[1])
from test_launch import programs
from legpush.options.run import RunOptions
from legpush.launch.run import launch_mission
sys.exit(launch_mission(RunOptions(scenario="push", out=Path(sys.argv[2])), Console(), programs("waits")))
"""


def programs(agent_does: str, film: str = "pass") -> Programs:
    """Small programs: an agent that `ends` at once, `forgets` its report, or `waits`; a film that runs `film`."""

    def process(role: Role, options: RunOptions, place: Place) -> tuple[str, ...]:
        return (sys.executable, "-c", PROCESS, role, "--out", str(place.folder), "--does", agent_does)

    return Programs(process=process, film=lambda folder: (sys.executable, "-I", "-S", "-c", film, str(folder)))


@dataclass
class Ended:
    """How a mission in this very process ended."""

    exit_code: int
    text: str
    folder: Path

    def pids(self) -> list[int]:
        return pids_of(self.folder)


def pids_of(folder: Path) -> list[int]:
    path = folder / "pids"
    return [int(pid) for pid in path.read_text().split()] if path.exists() else []


def is_running(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def wait_until_all_end(pids: list[int]) -> None:
    until = time.monotonic() + 30.0
    while any(map(is_running, pids)):
        assert time.monotonic() < until, f"still running: {[pid for pid in pids if is_running(pid)]}"


def run(folder: Path, agent_does: str = "ends", film: str = "pass", **options: bool) -> Ended:
    console = Console(file=StringIO(), width=200)
    run_options = RunOptions(scenario="push", out=folder, **options)  # type: ignore[arg-type]
    code = launch_mission(run_options, console, programs(agent_does, film))
    assert isinstance(console.file, StringIO)
    return Ended(code, console.file.getvalue(), folder)


def test_a_mission_ends_with_a_table_its_files_and_no_process(tmp_path: Path) -> None:
    film = "import pathlib, sys; (pathlib.Path(sys.argv[1]) / 'mission.mp4').touch()"
    ended = run(tmp_path / "run", film=film)
    assert ended.exit_code == 0
    for words in ("success", "1.2 cm", "report.json", "mission.mp4", "scenario.toml", "logs"):
        assert words in ended.text
    assert load_scenario(ended.folder / "scenario.toml") == load_scenario("push")
    logs = {path.name for path in (ended.folder / "logs").iterdir()}
    assert logs == {"planner.log", "sim.log", "agent.log", "video.log", "command.txt"}
    assert "run run, incarnation" in (ended.folder / "logs" / "sim.log").read_text()
    assert len(ended.pids()) == 3
    assert not any(map(is_running, ended.pids()))


def test_sockets_are_private_and_gone_afterwards(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    short = tmp_path / "t"
    short.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(short))
    ended = run(tmp_path / "run", film=f"import os; print(oct(os.stat('{short}/' + os.listdir('{short}')[0]).st_mode))")
    assert (ended.folder / "logs" / "video.log").read_text() == "0o40700\n"
    assert list(short.iterdir()) == []


def test_no_film_is_made_where_none_is_wanted(tmp_path: Path) -> None:
    ended = run(tmp_path / "run", film="raise SystemExit(5)", video=False)
    assert ended.exit_code == 0
    assert not (ended.folder / "logs" / "video.log").exists()


def test_a_machine_without_opengl_still_succeeds_and_says_so(tmp_path: Path) -> None:
    ended = run(tmp_path / "run", film="print('no video: install libegl1'); raise SystemExit(4)")
    assert ended.exit_code == 0
    assert "no video: install libegl1" in ended.text


def test_a_film_that_fails_does_not_spoil_the_mission_but_is_told_of(tmp_path: Path) -> None:
    ended = run(tmp_path / "run", film="print('out of film'); raise SystemExit(1)")
    assert ended.exit_code == 0
    assert f"no video: the film exited with 1; the end of {ended.folder}/logs/video.log:" in ended.text
    assert "\n    out of film\n" in ended.text


def test_an_agent_that_leaves_no_report_did_not_succeed(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path / "run", agent_does="forgets").exit_code == 3
    log = tmp_path / "run" / "logs" / "agent.log"
    said = capfd.readouterr().err
    assert said.startswith(f"error: the agent exited with 0 without a result of the mission; the end of {log}:\n    ")
    assert not any(map(is_running, pids_of(tmp_path / "run")))


def test_a_finished_run_can_be_looked_at_again_in_its_folder(tmp_path: Path) -> None:
    assert run(tmp_path / "run").exit_code == 0
    again = run(tmp_path / "run")
    assert again.exit_code == 0
    assert len(again.pids()) == 6


# -- the launcher as a process of its own ----------------------------------------------------------------------------


@pytest.fixture
def launcher(tmp_path: Path) -> subprocess.Popen[str]:
    """A launcher in its own session whose three processes are up and wait."""
    argv = [sys.executable, "-c", HARNESS, str(Path(__file__).parent), str(tmp_path / "run")]
    process = subprocess.Popen(
        argv, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )
    until = time.monotonic() + 60.0
    while len(pids_of(tmp_path / "run")) < 3:
        assert process.poll() is None, process.communicate()[0]
        assert time.monotonic() < until
    return process


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_launcher_ends_with_130_and_says_how_to_go_on(
    number: signal.Signals, launcher: subprocess.Popen[str], tmp_path: Path
) -> None:
    launcher.send_signal(number)
    text, _ = launcher.communicate(timeout=60)
    assert launcher.returncode == 130
    folder = tmp_path / "run"
    assert f"interrupted by {number.name}; to go on: legpush run {folder}/scenario.toml --seed 0" in text
    assert not any(map(is_running, pids_of(folder)))


def test_ctrl_c_reaches_the_launcher_alone(launcher: subprocess.Popen[str], tmp_path: Path) -> None:
    groups = {os.getpgid(pid) for pid in pids_of(tmp_path / "run")}
    assert len(groups) == 3
    assert os.getpgid(launcher.pid) not in groups
    os.killpg(launcher.pid, signal.SIGINT)
    launcher.communicate(timeout=60)
    assert launcher.returncode == 130


def test_not_even_a_killed_launcher_leaves_processes(launcher: subprocess.Popen[str], tmp_path: Path) -> None:
    pids = pids_of(tmp_path / "run")
    launcher.kill()
    launcher.communicate(timeout=60)
    wait_until_all_end(pids)


def test_a_killed_process_is_started_again_and_the_mission_goes_on(
    launcher: subprocess.Popen[str], tmp_path: Path
) -> None:
    folder = tmp_path / "run"
    os.kill(pids_of(folder)[0], signal.SIGKILL)
    until = time.monotonic() + 60.0
    while len(pids_of(folder)) < 4:
        assert time.monotonic() < until
    launcher.send_signal(signal.SIGTERM)
    text, _ = launcher.communicate(timeout=60)
    assert "was killed by SIGKILL; starting it again (1 of 3)" in text
    assert not any(map(is_running, pids_of(folder)))
