"""Turns in the simulator: the feet keep apart from each other, whatever path takes the place of another one."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Outcome, Reset, Walk
from legpush.scene.scenario import PoseDeg, Room, Scenario
from sim_proc.simulator import Simulator
from tests.robots import ROBOT


def turned(place: Pose2, yaw_rad: float) -> Pose2:
    return place @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=yaw_rad)


def ahead(place: Pose2, x_m: float) -> Pose2:
    return place @ Pose2(x_m=x_m, y_m=0.0, yaw_rad=0.0)


def walk_on(simulator: Simulator, outcome: Outcome) -> Outcome:
    n_cycles = 0
    while outcome.world.path is not None and not (outcome.world.fallen or outcome.world.path.done):
        outcome = simulator.perform(Walk(), with_trace=False)
        n_cycles += 1
        assert n_cycles < 40
    return outcome


@pytest.fixture
def open_floor(at_the_box: Scenario) -> Scenario:
    far = replace(at_the_box.box, pose=PoseDeg(x_m=1.0, y_m=1.0, yaw_deg=0.0))
    start = PoseDeg(x_m=6.0, y_m=6.0, yaw_deg=0.0)
    return replace(at_the_box, room=Room(size_m=(12.0, 12.0)), start=start, box=far)


@pytest.mark.parametrize(
    ("first_rad", "other_rad"), [(-1.4514, 1.8448), (-0.7871, 0.9342), (-2.0986, 1.7862), (1.4514, -1.8448)]
)
def test_a_turn_that_another_one_takes_the_place_of_is_walked_to_its_end(
    first_rad: float, other_rad: float, open_floor: Scenario
) -> None:
    """In the first cycle the right feet land where the first turn leads; the left ones must not step onto them."""
    simulator = Simulator()
    start = open_floor.start.pose()
    corner = ahead(start, 0.3)
    simulator.perform(Reset(scenario=open_floor, seed=0), with_trace=False)
    simulator.perform(Follow(waypoints=(start, corner, turned(corner, first_rad))), with_trace=False)
    here = planar_pose(simulator.perform(Walk(), with_trace=False).world.trunk)

    other = turned(here, other_rad)
    last = walk_on(simulator, simulator.perform(Follow(waypoints=(here, other, ahead(other, 0.5))), with_trace=False))

    assert not last.world.fallen
    end = ahead(other, 0.5)
    corners = end.apply(ROBOT.stance.foot_rectangle_b())
    np.testing.assert_allclose(np.array(last.world.tips_m)[:, :2], corners, atol=0.015)
