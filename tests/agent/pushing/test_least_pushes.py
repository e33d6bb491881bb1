"""How far a push can move a box, and how far a box has to be moved."""

from math import dist, inf, radians

import pytest
from msgspec.structs import replace

import legpush
from agent_proc.pushing.least_pushes import least_distance_m, most_travel_m
from legpush.bounds import MAX_DEPTH_M
from legpush.messages.stepping import Push
from legpush.realism.settings import Randomization
from legpush.scene.reference import Arcs, Left, Straight
from legpush.scene.scenario import Goal, PoseDeg, Room
from tests.agent.fake_world import scenario_at_station

SCENARIO = scenario_at_station()
BOX = SCENARIO.box.pose.pose()
CURVES = [(0.5, 0.5), (1.0, 1.0)]
"""That of the default policy, and the one after which a box slides farthest."""


@pytest.mark.parametrize(("w1", "w2"), CURVES)
@pytest.mark.parametrize("friction", [0.05, 0.1, 0.5])
def test_no_push_of_the_simulator_moves_a_box_farther(friction: float, w1: float, w2: float) -> None:
    changes = {"box.friction": friction, "room.size_m": [12.0, 4.0]}
    with legpush.world("push", seed=0, changes=changes) as world:
        before = world.box
        world.step(Push(w1=w1, w2=w2, leg="FL", depth_m=MAX_DEPTH_M))
        moved_m = dist(before.xy(), world.box.xy())
        assert 0.15 < moved_m < most_travel_m(world.scenario)


@pytest.mark.parametrize(("slope_deg", "slides"), [(0.0, False), (2.0, False), (8.0, True)])
def test_a_box_that_slides_by_itself_has_no_farthest_place(slope_deg: float, slides: bool) -> None:
    box, room = replace(SCENARIO.box, friction=0.1), Room(size_m=(12.0, 6.0), slope_deg=slope_deg)
    assert (most_travel_m(replace(SCENARIO, box=box, room=room)) == inf) is slides


@pytest.mark.parametrize("offset_m", [0.0, 0.3])
def test_a_box_has_to_come_to_the_tolerance_of_its_goal_from_wherever_it_may_be(offset_m: float) -> None:
    goal = Goal(pose=PoseDeg(x_m=9.0, y_m=7.0, yaw_deg=0.0), position_tolerance_m=0.5)
    scenario = replace(SCENARIO, goal=goal, randomization=Randomization(box_xy_m=offset_m))
    assert least_distance_m(scenario, BOX, None) == pytest.approx(5.0 - 0.5 - 2**0.5 * offset_m)
    assert least_distance_m(scenario, goal.pose.pose(), None) == 0.0


def test_a_reference_may_be_followed_on_the_inner_side_of_its_curves() -> None:
    arc_m = 0.5 * radians(90.0)
    reference = Arcs(radius_m=0.5, segments=(Straight(length_m=1.0), Left(angle_deg=90.0)))
    scenario = replace(SCENARIO, reference=reference, goal=replace(SCENARIO.goal, position_tolerance_m=0.2))
    least_m = least_distance_m(scenario, SCENARIO.goal.pose.pose(), 1.0 + arc_m)
    inner_m = 1.0 + (0.5 - 0.1) * radians(90.0) - 0.2
    assert 0.7 * inner_m < least_m < inner_m
