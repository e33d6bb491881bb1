"""Boxes that are pushed through doors, and doors that the robot could not walk through later."""

import pytest

from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.messages.stepping import Follow, Push
from legpush.scene.scenario import Box, Goal, PoseDeg, PushSettings, Rectangle, Room, Scenario
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario


def behind_a_door(goal: PoseDeg, box_x_m: float = 2.8, *closet: Rectangle) -> Scenario:
    """A wall with a door of 0.7 m: box and the robot behind it fit through, but a walk needs 0.88 m."""
    wall = (
        Rectangle(x_min_m=3.9, x_max_m=4.05, y_min_m=0.0, y_max_m=2.15),
        Rectangle(x_min_m=3.9, x_max_m=4.05, y_min_m=2.85, y_max_m=5.0),
    )
    return make_scenario(
        (1.2, 2.5, 0.0),
        room=Room(size_m=(8.0, 5.0), obstacles=(*wall, *closet)),
        box=Box(pose=PoseDeg(x_m=box_x_m, y_m=2.5, yaw_deg=0.0)),
        goal=Goal(pose=goal),
        pushing=PushSettings(max_iterations=400),
    )


CLOSET = (
    Rectangle(x_min_m=5.6, x_max_m=8.0, y_min_m=0.0, y_max_m=5.0),
    Rectangle(x_min_m=4.05, x_max_m=5.6, y_min_m=0.0, y_max_m=1.9),
)
"""What leaves no space behind the door to walk around the box."""


@pytest.mark.parametrize(
    ("goal", "closet", "faces"),
    [
        (PoseDeg(x_m=4.9, y_m=2.5, yaw_deg=0.0), CLOSET, {"rear"}),
        (PoseDeg(x_m=6.0, y_m=2.5, yaw_deg=0.0), (), {"rear"}),
        (PoseDeg(x_m=6.0, y_m=3.5, yaw_deg=0.0), (), {"rear", "right"}),
    ],
)
def test_a_box_is_pushed_through_a_door_if_no_walk_needs_the_door(
    goal: PoseDeg, closet: tuple[Rectangle, ...], faces: set[str]
) -> None:
    """A change of faces behind the door needs it only where there is no space to walk around the box."""
    world = FakeWorld(planner=make_plan)
    result = run_mission(world, behind_a_door(goal, 2.8, *closet), 7, ScriptedPolicy())

    assert result.success, result.detail
    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} == faces


@pytest.mark.parametrize(
    ("scenario", "words"),
    [
        (behind_a_door(PoseDeg(x_m=4.9, y_m=3.7, yaw_deg=0.0), 2.8, *CLOSET), "its walk needs a passage of 0.88 m"),
        (behind_a_door(PoseDeg(x_m=1.5, y_m=2.5, yaw_deg=0.0), 5.5), "the way to the box, to its front face: "),
    ],
)
def test_a_door_that_a_walk_needs_and_that_is_too_narrow_for_it_is_refused_before_the_robot_moves(
    scenario: Scenario, words: str
) -> None:
    world = FakeWorld(planner=make_plan)
    result = run_mission(world, scenario, 7, ScriptedPolicy())

    assert (result.reason, world.motions(Follow)) == ("no_path", [])
    assert words in result.detail
    assert "`planning.margin_m` (0.1 m), with which a walk needs passages of 0.88 m" in result.remedy
