"""Missions whose box stands at its goal, or so near that nothing is left to push, with planner and physics."""

from math import cos, radians, sin

import pytest

import legpush
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario


def at_goal(ahead_m: float, turn_deg: float, heading_deg: float) -> Scenario:
    """An empty room; the goal is a little ahead of the box, and turned."""
    along = radians(heading_deg)
    box = PoseDeg(x_m=5.0, y_m=3.0, yaw_deg=heading_deg)
    goal = PoseDeg(x_m=5.0 + ahead_m * cos(along), y_m=3.0 + ahead_m * sin(along), yaw_deg=heading_deg + turn_deg)
    return Scenario(
        name="at_goal",
        room=Room(size_m=(10.0, 6.0)),
        start=PoseDeg(x_m=2.5, y_m=3.0, yaw_deg=0.0),
        box=Box(pose=box),
        goal=Goal(pose=goal),
    )


@pytest.mark.parametrize(
    ("ahead_m", "turn_deg", "heading_deg"),
    [(0.0, 0.0, 0.0), (0.0, 0.0, 137.0), (1e-6, 0.0, 0.0), (-0.005, 0.0, 30.0), (0.01, 0.0, 0.0), (0.0, 2.0, 0.0)],
)
def test_a_mission_whose_box_is_at_its_goal_succeeds_without_a_push(
    ahead_m: float, turn_deg: float, heading_deg: float
) -> None:
    run = legpush.run(at_goal(ahead_m, turn_deg, heading_deg), policy="scripted")

    assert (run.report.reason, run.report.n_push_cycles, run.report.remedy) == ("success", 0, "")
