"""`legpush scenarios random` with a planner process."""

import subprocess
import sys
from pathlib import Path

import pytest

from agent_proc.pushing.solvable import solvable_by
from legpush.messages.planning import BoxPathQuery, Plan, PlanQuery, TrunkPathQuery
from legpush.scenarios.file import load_scenario
from legpush.scenarios.random_room import RandomRoom
from legpush.scenarios.random_scenario import random_scenario
from planner_proc.planning import make_plan

LEGPUSH = str(Path(sys.executable).with_name("legpush"))
SMALL = RandomRoom(size_m=(5.0, 5.0), obstacles=4, corridor_m=1.1)
SEED = 9


def test_a_room_is_the_first_one_that_the_planner_finds_a_way_through(tmp_path: Path) -> None:
    options = ("--size-m", "5", "5", "--obstacles", "4", "--corridor-m", "1.1", "--seed", str(SEED))
    command = [LEGPUSH, "scenarios", "random", "room.toml", *options]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=240)

    assert (done.returncode, done.stdout) == (0, "wrote room.toml\n"), done.stderr
    assert load_scenario(tmp_path / "room.toml") == random_scenario(SMALL, SEED, solvable_by(make_plan, SEED))


@pytest.mark.parametrize(("kind", "expected"), [(None, True), (BoxPathQuery, False), (TrunkPathQuery, False)])
def test_both_the_box_and_the_robot_need_a_way(kind: type[PlanQuery] | None, expected: bool) -> None:
    scenario = random_scenario(SMALL, SEED, lambda _: True)

    def plan(query: PlanQuery) -> Plan:
        return Plan(status="failed", reason="none") if kind and isinstance(query, kind) else make_plan(query)

    assert solvable_by(plan, SEED)(scenario) is expected
