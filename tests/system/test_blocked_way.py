"""A mission with the real processes in which the way is blocked while the robot walks."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from legpush.history.steps import PlanRecord, StepRecord, read_episode
from legpush.messages.planning import TrunkPathQuery
from legpush.scenarios.changes import override
from legpush.scenarios.file import dump_scenario, load_scenario
from sim_proc.simulator import Simulator

LEGPUSH = str(Path(sys.executable).with_name("legpush"))
LIMIT_S = 180.0


def run(scenario_file: Path, out: Path) -> dict[str, Any]:
    """Run the mission to its success, or make the report of one that is over; returns the report."""
    command = [LEGPUSH, "run", str(scenario_file), "--seed", "5", "--out", str(out), "--no-video"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "room.obstacles[7] at 6.0 s" in done.stdout
    report: dict[str, Any] = json.loads((out / "report.json").read_text())
    return report


@pytest.fixture(scope="module")
def scenario_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped scenario with a goal so near that the crate is not in the way."""
    scenario = override(load_scenario("blocked_way"), {"goal.pose.x_m": 8.0, "goal.pose.y_m": 3.0})
    file = tmp_path_factory.mktemp("scenario") / "blocked_way.toml"
    file.write_text(dump_scenario(scenario))
    return file


@pytest.fixture(scope="module")
def mission(scenario_file: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """The folder of the run and its report."""
    out = tmp_path_factory.mktemp("blocked") / "run"
    return out, run(scenario_file, out)


def test_the_robot_takes_another_way_to_the_box(mission: tuple[Path, dict[str, Any]]) -> None:
    out, report = mission
    records = list(read_episode(out / "episode-0000.journal"))
    highest_m = max(r.outcome.world.trunk.position_m[1] for r in records if isinstance(r, StepRecord))
    ways = [r for r in records if isinstance(r, PlanRecord) and isinstance(r.query, TrunkPathQuery)]

    assert (report["success"], report["n_replans"]) == (True, 1)
    assert report["appeared"][0] == {"obstacle": 7, "time_s": 6.0}
    assert highest_m > 6.2
    assert max(pose.y_m for pose in ways[0].plan.waypoints) < 3.8
    assert sum(ways[1].query.grid.cells) > sum(ways[0].query.grid.cells)


def test_the_recorded_motions_make_it_appear_at_the_same_tick_in_this_process(
    mission: tuple[Path, dict[str, Any]],
) -> None:
    out, report = mission
    simulator, n_steps = Simulator(), 0
    for record in read_episode(out / "episode-0000.journal"):
        if isinstance(record, StepRecord):
            outcome = simulator.perform(record.motion, with_trace=True)
            assert outcome == record.outcome
            n_steps += 1
    assert n_steps > 30
    assert f"{outcome.state_crc:08x}" == report["state_crc"]


def test_a_mission_that_is_answered_from_its_journal_ends_as_it_did(
    mission: tuple[Path, dict[str, Any]], scenario_file: Path
) -> None:
    out, report = mission
    (out / "report.json").unlink()

    assert run(scenario_file, out) == report
