"""Whole missions with the real processes: whatever happens to them, equal seeds end in equal states."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from itertools import permutations
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Any

import psutil
import pytest

from legpush.bus import endpoints
from legpush.history.journal import Acted, Entry, Queried, read_entries
from legpush.history.steps import StepRecord, read_episode
from legpush.messages.common import Role
from legpush.messages.stepping import Push, Walk
from legpush.scenarios.file import dump_scenario, load_scenario, override
from sim_proc.simulator import Simulator

LEGPUSH = str(Path(sys.executable).with_name("legpush"))
SEED = 4711
LIMIT_S = 180.0
ROLES: tuple[Role, ...] = ("planner", "sim", "agent")


@pytest.fixture(scope="module")
def scenario_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The default mission with a planner that thinks long enough to be killed meanwhile."""
    scenario = override(load_scenario("default"), {"planning.planner": "rrt_star", "planning.max_iterations": 8_000})
    file = tmp_path_factory.mktemp("scenario") / "thorough.toml"
    file.write_text(dump_scenario(scenario))
    return file


def run_command(scenario_file: Path, out: Path, *flags: str) -> list[str]:
    return [
        LEGPUSH,
        "run",
        "--scenario",
        str(scenario_file),
        "--seed",
        str(SEED),
        "--out",
        str(out),
        "--no-video",
        *flags,
    ]


def report_of(out: Path) -> dict[str, Any]:
    report: dict[str, Any] = json.loads((out / "report.json").read_text())
    return report


@pytest.fixture(scope="module")
def undisturbed(scenario_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run that nothing happened to."""
    out = tmp_path_factory.mktemp("undisturbed") / "run"
    done = subprocess.run(run_command(scenario_file, out), capture_output=True, text=True, timeout=LIMIT_S, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


def test_the_mission_succeeds_within_its_numbers(undisturbed: Path) -> None:
    report = report_of(undisturbed)
    assert report["success"]
    assert report["box_position_error_m"] <= 0.03
    assert report["box_angle_error_deg"] <= 3.0
    assert report["walk_tracking_rms_m"] <= 0.05
    assert max(report["trunk_max_abs_pitch_deg"], report["trunk_max_abs_roll_deg"]) <= 5.0
    assert report["min_support_margin_m"] > 0.0
    assert report["handover_distance_m"] <= 3.0
    assert report["n_push_cycles"] > 0
    assert (undisturbed / "mission.png").stat().st_size > 50_000


def test_the_recorded_motions_lead_a_simulator_in_this_process_to_the_same_states(undisturbed: Path) -> None:
    simulator = Simulator()
    n_steps = 0
    for record in read_episode(undisturbed / "episode-0000.journal"):
        if isinstance(record, StepRecord):
            outcome = simulator.perform(record.motion, with_trace=record.outcome.trace is not None)
            assert outcome == record.outcome
            n_steps += 1
    assert n_steps > 30
    assert f"{outcome.state_crc:08x}" == report_of(undisturbed)["state_crc"]


def test_a_channel_that_drops_duplicates_delays_and_reorders_changes_nothing(
    undisturbed: Path, scenario_file: Path, tmp_path: Path
) -> None:
    command = run_command(scenario_file, tmp_path / "run", "--inject-faults", "0.2")
    done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert report_of(tmp_path / "run")["state_crc"] == report_of(undisturbed)["state_crc"]
    logs = "".join((tmp_path / "run" / "logs" / f"{role}.log").read_text() for role in ROLES)
    assert "'late'" in logs


PHASES: dict[str, Callable[[list[Entry]], bool]] = {
    "planning": lambda entries: isinstance(entries[-1], Queried),
    "walking": lambda entries: _last_motion_is(entries, Walk),
    "pushing": lambda entries: _last_motion_is(entries, Push),
}


def _last_motion_is(entries: list[Entry], kind: type[Walk] | type[Push]) -> bool:
    acted = [entry for entry in entries if isinstance(entry, Acted)]
    return bool(acted) and isinstance(acted[-1].motion, kind)


@pytest.mark.parametrize("role", ROLES)
def test_a_process_killed_while_planning_walking_and_pushing_changes_nothing(
    role: Role, undisturbed: Path, scenario_file: Path, tmp_path: Path
) -> None:
    out = tmp_path / "run"
    launcher = subprocess.Popen(
        run_command(scenario_file, out), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    try:
        killed: set[int] = set()
        for phase, reached in PHASES.items():
            _wait_for(launcher, lambda reached=reached: _in_phase(out, reached), f"{role}: {phase}")  # type: ignore[misc]
            _wait_for(launcher, lambda: _child(launcher, role, killed) is not None, f"a {role} to kill")
            victim = _child(launcher, role, killed)
            assert victim is not None
            victim.kill()
            killed.add(victim.pid)
        output, _ = launcher.communicate(timeout=LIMIT_S)
    finally:
        _end(launcher)
    assert launcher.returncode == 0, output
    assert output.count(f"the {role} was killed by SIGKILL; starting it again") == len(PHASES)
    report, expected = report_of(out), report_of(undisturbed)
    times = {"wall_time_s", "real_time_factor"}
    assert {key: report[key] for key in report.keys() - times} == {
        key: expected[key] for key in expected.keys() - times
    }


def _in_phase(out: Path, reached: Callable[[list[Entry]], bool]) -> bool:
    journal = out / "episode-0000.journal"
    if not journal.exists():
        return False
    entries = list(read_entries(journal))
    return len(entries) > 1 and reached(entries)


def _child(launcher: subprocess.Popen[str], role: Role, killed: set[int]) -> psutil.Process | None:
    for process in psutil.Process(launcher.pid).children(recursive=True):
        try:
            if f"{role}_proc" in process.cmdline() and process.pid not in killed:
                return process
        except psutil.NoSuchProcess:
            continue
    return None


def _wait_for(launcher: subprocess.Popen[str], condition: Callable[[], bool], what: str) -> None:
    """Look until the condition holds; fail if the launcher ends before, or after `LIMIT_S`."""
    pause, until = Event(), monotonic() + LIMIT_S
    while not condition():
        if launcher.poll() is not None:
            output, _ = launcher.communicate()
            pytest.fail(f"The run ended before {what}:\n{output}")
        assert monotonic() < until, f"waited too long for {what}"
        pause.wait(0.001)


def _end(launcher: subprocess.Popen[str]) -> None:
    if launcher.poll() is None:
        launcher.send_signal(signal.SIGTERM)
        launcher.communicate(timeout=30.0)


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def test_the_order_in_which_the_processes_start_changes_nothing(tmp_path: Path, stack: ExitStack) -> None:
    crcs = {}
    for order in permutations(ROLES):
        sockets = tmp_path / "-".join(order)
        sockets.mkdir(mode=0o700)
        started: dict[Role, subprocess.Popen[str]] = {}
        for role in order:
            at = endpoints.in_directory(sockets, role)
            flags = ["--run", "order", "--listen", *at.listen]
            flags += ["--connect", *at.connect] if at.connect else []
            if role == "agent":
                flags += ["--scenario", "push", "--seed", str(SEED), "--out", str(sockets / "out")]
            process = subprocess.Popen(
                [sys.executable, "-m", f"{role}_proc", *flags], stderr=subprocess.PIPE, text=True
            )
            stack.callback(process.kill)
            started[role] = process
            if role != "agent":
                _wait_until_it_speaks(process)
        _, words = started["agent"].communicate(timeout=LIMIT_S)
        assert started["agent"].returncode == 0, words
        for role in ("planner", "sim"):
            started[role].send_signal(signal.SIGTERM)
            _, words = started[role].communicate(timeout=30.0)
            assert started[role].returncode == 0, words
        crcs[order] = report_of(sockets / "out")["state_crc"]
    assert len(crcs) == 6
    assert len(set(crcs.values())) == 1, crcs


def _wait_until_it_speaks(process: subprocess.Popen[str]) -> None:
    """Its first log line: the process runs, so that the next one is started after it."""
    assert process.stderr is not None
    assert process.stderr.readline()


def test_no_process_is_large_and_only_the_agent_may_load_torch(scenario_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    launcher = subprocess.Popen(
        run_command(scenario_file, out), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    largest = dict.fromkeys(ROLES, 0)
    torch: set[Role] = set()
    try:
        _wait_for(launcher, lambda: _in_phase(out, PHASES["pushing"]), "pushing")
        for role in ROLES:
            process = _child(launcher, role, set())
            assert process is not None
            largest[role] = process.memory_info().rss
            if any("torch" in region.path for region in process.memory_maps()):
                torch.add(role)
        launcher.communicate(timeout=LIMIT_S)
    finally:
        _end(launcher)
    assert launcher.returncode == 0
    assert largest["sim"] < 250e6
    assert largest["planner"] < 250e6
    assert largest["agent"] < 500e6
    assert min(largest.values()) > 10e6
    assert torch <= {"agent"}
