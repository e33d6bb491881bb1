"""Queries of both kinds: equal ones get equal plans anywhere, and invalid ones say why."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any, get_args

import pytest
from msgspec.structs import replace

from legpush.messages.codec import encode
from legpush.messages.planning import PlanQuery
from legpush.plans.planner import PlanningInterruptedError
from legpush.scene.names import PlannerName
from legpush.scene.plan_settings import Anytime
from legpush.scene.scenario import Rectangle
from planner_proc.planning import make_plan, make_plans
from tests.planner import boxes, maps

QUERY = maps.query(maps.MAZE, (1.0, 1.0, -1.0), (7.0, 5.0, 2.0))
BOX_QUERY = boxes.query(boxes.OPEN, maps.pose(4.0, 4.0), maps.pose(5.0, 5.0))


@pytest.mark.parametrize(
    "query",
    [
        *(
            replace(QUERY, planner=planner, seed=7, max_iterations=1500)
            for planner in ("rrt", "rrt_connect", "rrt_star")
        ),
        BOX_QUERY,
    ],
)
def test_equal_queries_get_equal_plans_here_and_in_another_process(query: PlanQuery, tmp_path: Path) -> None:
    plan = make_plan(query)
    assert plan.status == "exact"
    make_plan(replace(query, seed=8))
    assert make_plan(query) == plan
    (tmp_path / "query").write_bytes(encode(query))
    script = """
import sys
from pathlib import Path
from legpush.messages.codec import decode, encode
from legpush.messages.planning import PlanQuery
from planner_proc.planning import make_plan
folder = Path(sys.argv[1])
(folder / "plan").write_bytes(encode(make_plan(decode((folder / "query").read_bytes(), PlanQuery))))
"""
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")
    assert (tmp_path / "plan").read_bytes() == encode(plan)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"n_rows": 59}, r"Expected n_rows \* n_columns = 59 \* 80 = 4720 cells, got 4800"),
        ({"n_rows": 10**5, "n_columns": 10**5}, "Expected at most 16777216 cells, got .* 10000000000"),
        (
            {"cells": bytes(4799) + b"\x02"},
            r"Expected cells of 0 \(free\) or 1 .*, got 2 in row 59, column 79",
        ),
        ({"origin_m": (1e15, 0.0)}, r"Expected a map within 1e\+07 m of \(0, 0\), got x 1e\+15"),
        ({"resolution_m": 1e300}, "Expected a map within"),
    ],
)
def test_a_grid_that_is_invalid_says_why(changes: dict[str, Any], reason: str) -> None:
    grid = replace(maps.MAZE, **changes)
    assert_invalid(replace(QUERY, grid=grid), reason)
    assert_invalid(replace(BOX_QUERY, grid=grid), reason)


@pytest.mark.parametrize("query", [QUERY, BOX_QUERY])
def test_a_step_that_is_too_small_or_no_number_is_invalid(query: PlanQuery) -> None:
    assert_invalid(replace(query, step_m=1e-9), "Expected step_m of at least 1e-06 m, got 1e-09")
    assert_invalid(replace(query, step_m=float("nan")), "Expected step_m of at least 1e-06 m, got nan")


def test_a_search_that_cannot_do_what_is_asked_is_invalid() -> None:
    asked = replace(QUERY, planner="rrt_connect", steering="dubins", min_turning_radius_m=0.5)
    assert_invalid(asked, "Expected a planner that can be steered by dubins")


def assert_invalid(query: PlanQuery, reason: str) -> None:
    plan = make_plan(query)
    assert (plan.status, plan.waypoints, plan.raw_path_m) == ("invalid", (), ())
    assert re.search(reason, plan.reason)


@pytest.mark.parametrize("planner", get_args(PlannerName))
def test_a_search_stops_when_it_is_interrupted(planner: PlannerName) -> None:
    n_asked = 0

    def interrupted() -> bool:
        nonlocal n_asked
        n_asked += 1
        return n_asked > 5

    cut = maps.room((3.9, 4.1, 0.0, 6.0))
    query = maps.query(cut, (1.0, 3.0), (7.0, 3.0), planner=planner, anytime=Anytime(n_improvements=100))
    with pytest.raises(PlanningInterruptedError):
        list(make_plans(query, interrupted))
    assert n_asked < 20


def test_a_search_for_a_path_of_the_box_stops_too() -> None:
    wall = Rectangle(x_min_m=3.9, x_max_m=4.1, y_min_m=0.0, y_max_m=8.0)
    query = boxes.query(replace(boxes.OPEN, obstacles=(wall,)), maps.pose(2.5, 4.0), maps.pose(5.5, 4.0))
    with pytest.raises(PlanningInterruptedError):
        list(make_plans(query, lambda: True))


def test_the_planner_loads_no_physics_and_no_learning_and_leaves_quietly() -> None:
    script = """
import sys
import planner_proc.planning
from tests.planner import maps
for planner in ("rrt", "rrt_connect", "rrt_star"):
    query = maps.query(maps.room((3.0, 4.0, 0.0, 4.0)), (1.0, 1.0), (7.0, 1.0), planner=planner, max_iterations=500)
    planner_proc.planning.make_plan(query)
print(sorted({"mujoco", "torch", "stable_baselines3", "gymnasium", "matplotlib", "zenoh"} & set(sys.modules)))
raise KeyboardInterrupt
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False, cwd=Path(__file__).parents[2]
    )
    assert done.stdout == "[]\n"
    assert done.stderr.splitlines()[-1] == "KeyboardInterrupt"
    assert "nanobind" not in done.stderr
