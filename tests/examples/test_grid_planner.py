"""The example planner: its plans are what they say, judged by the built-in planner's exact distances."""

import importlib
from itertools import pairwise
from math import hypot
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages import codec
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.occupancy import occupancy_grid
from legpush.scene.plan_settings import Smoothing
from legpush.scene.scenario import Rectangle, Room
from planner_proc.clearance.field import ClearanceField
from tests.planner.boxes import OPEN, SIDES, check, query
from tests.planner.maps import pose

FOLDER = Path(__file__).parents[2] / "examples"
CLEARANCE_M = 0.4


def example() -> Any:
    """The module in the file, which finds its neighbour as it does when it is run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(FOLDER))
        return importlib.import_module("grid_planner")


PLANNER = example()


def answer(asked: msgspec.Struct) -> Plan:
    """What it answers, through the same bytes as on the bus."""
    plain = codec.unpack(codec.encode(asked))
    is_trunk = isinstance(asked, TrunkPathQuery)
    return codec.convert(PLANNER.plan_trunk(plain) if is_trunk else PLANNER.plan_box(plain, PLANNER.fits), Plan)


def trunk_query(room: Room, start: Pose2, goal: Pose2) -> TrunkPathQuery:
    return TrunkPathQuery(
        grid=occupancy_grid(room),
        start=start,
        goal=goal,
        clearance_m=CLEARANCE_M,
        planner="rrt_connect",
        seed=0,
        max_iterations=1000,
        goal_bias=0.05,
        step_m=0.5,
        goal_region_m=0.25,
        steering="straight",
        min_turning_radius_m=0.0,
        smoothing=Smoothing(),
        anytime=None,
    )


def wall(*gap: float) -> Room:
    """A wall across the room with a gap between two heights."""
    low, high = gap
    return Room(
        size_m=(6.0, 4.0),
        obstacles=(
            Rectangle(x_min_m=2.9, x_max_m=3.1, y_min_m=0.0, y_max_m=low),
            Rectangle(x_min_m=2.9, x_max_m=3.1, y_min_m=high, y_max_m=4.0),
        ),
    )


@pytest.mark.parametrize(("room", "longest_m"), [(Room(size_m=(6.0, 4.0)), 4.01), (wall(2.6, 3.8), 6.0)])
def test_a_way_of_the_trunk_keeps_its_clearance_everywhere(room: Room, longest_m: float) -> None:
    start, goal = pose(1.0, 1.0, 2.0), pose(5.0, 1.0, -1.0)
    asked = trunk_query(room, start, goal)
    plan = answer(asked)

    assert plan.status == "exact", plan.reason
    assert (plan.waypoints[0], plan.waypoints[-1]) == (start, goal)
    points = np.array([waypoint.xy() for waypoint in plan.waypoints])
    assert ClearanceField(asked.grid).path_clearance_m(points) >= CLEARANCE_M - 1e-9
    steps = [hypot(*(b - a)) for a, b in pairwise(points)]
    assert max(steps) <= 0.0501
    assert sum(steps) == pytest.approx(plan.length_m, rel=1e-6)
    assert sum(steps) < longest_m
    assert answer(asked) == plan


def test_what_cannot_be_is_said() -> None:
    start, goal = pose(1.0, 1.0), pose(5.0, 1.0)
    assert answer(trunk_query(wall(2.0, 2.7), start, goal)).status == "failed"
    near = answer(trunk_query(wall(2.6, 3.8), start, pose(2.8, 1.0)))
    assert near.status == "invalid"
    assert "the goal (2.8, 1.0) is less than 0.4 m from an obstacle" in near.reason


@pytest.mark.parametrize("goal", [pose(6.0, 4.0), pose(6.0, 4.05, 0.09), pose(5.5, 5.5, 1.57), pose(2.0, 4.0)])
def test_a_path_of_the_box_is_one(goal: Pose2) -> None:
    asked = query(OPEN, pose(4.0, 4.0), goal)
    plan = answer(asked)

    check(asked, OPEN, replace(plan, min_clearance_m=0.0))


def test_a_box_that_has_no_way_is_said_to_have_none() -> None:
    asked = query(Room(size_m=(8.0, 1.6)), pose(2.0, 0.8), pose(5.0, 0.8, 1.57), sides=SIDES[:1])

    assert answer(asked).status == "failed"
