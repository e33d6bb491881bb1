"""Rough floors: when the feet find one, how they step there, and walks over it in the physics."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Reset, Walk
from legpush.realism.settings import FloorTiles, Realism
from legpush.scene.scenario import PoseDeg, Scenario
from sim_proc.control.feedback.terrain import Terrain
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.floors import lay_tile

ROUGH = ROBOT.rough
TOUCHDOWN_M = ROBOT.touchdown_m


def standing(*heights_m: float) -> Floats:
    """Feet at the corners of the foot rectangle, each this much above the level floor, (4, 3)."""
    corners = ROBOT.stance.foot_rectangle_b()
    return np.column_stack([corners, np.array(heights_m) + TOUCHDOWN_M])


def on(*heights_m: float) -> Terrain:
    terrain = Terrain(ROBOT)
    terrain.feel(standing(*heights_m), missed=False)
    return terrain


def test_feet_at_nearly_the_same_height_stand_on_a_level_floor() -> None:
    terrain = on(0.002, -0.004, 0.0, 0.005)
    assert not terrain.rough
    assert terrain.trunk_height_m(standing(0.002, -0.004, 0.0, 0.005)) == ROBOT.stance.height_m
    assert terrain.least_heights_m(standing(0.0, 0.0, 0.0, 0.0), 0) is None


def test_a_foot_that_stands_higher_or_missed_its_place_makes_the_floor_rough() -> None:
    assert on(0.0, 0.02, 0.0, 0.0).rough
    assert on(0.0, 0.0, -0.02, 0.0).rough
    terrain = Terrain(ROBOT)
    terrain.feel(standing(0.0, 0.0, 0.0, 0.0), missed=True)
    assert terrain.rough
    terrain.feel(standing(0.0, 0.0, 0.0, 0.0), missed=False)
    assert not terrain.rough
    place_m = standing(0.0, 0.0, 0.0, 0.0)[0]
    assert terrain.has_missed(np.add(place_m, [ROUGH.missed_m + 0.01, 0.0, 0.0]), place_m[:2])
    assert not terrain.has_missed(np.add(place_m, [0.0, ROUGH.missed_m - 0.01, 0.05]), place_m[:2])


def test_the_trunk_follows_the_mean_height_of_the_feet() -> None:
    feet = standing(0.08, 0.04, 0.0, 0.0)
    assert on(0.08, 0.04, 0.0, 0.0).trunk_height_m(feet) == pytest.approx(ROBOT.stance.height_m + 0.03)


def test_a_foot_rises_above_the_highest_one_moves_along_and_ends_below_the_lowest_one() -> None:
    feet, target_m = standing(0.08, 0.04, 0.0, -0.02), np.array([0.6, 0.2])
    terrain = on(0.08, 0.04, 0.0, -0.02)
    curve = terrain.swing(feet, 2, target_m)
    highest, lowest = feet[:, 2].max(), feet[:, 2].min()
    assert curve[:, 2].max() == pytest.approx(highest + ROUGH.step_height_m)
    assert curve[-1, 2] < lowest - ROUGH.below_m + 1e-9
    np.testing.assert_allclose(curve[-1, :2], target_m)
    moves = np.linalg.norm(np.diff(curve[:, :2], axis=0), axis=1) > 1e-3
    assert (curve[1:][moves, 2] > highest).all()
    slow = curve[terrain.slow_from_tick :]
    np.testing.assert_allclose(np.diff(slow[:, 2]), -ROUGH.descent_m_s * 0.02)
    np.testing.assert_array_equal(slow[:, :2], np.tile(target_m, (len(slow), 1)))


def test_standing_feet_have_slipped_off_an_edge_once_they_sink() -> None:
    feet = standing(0.08, 0.04, 0.0, 0.0)
    least = on(0.08, 0.04, 0.0, 0.0).least_heights_m(feet, 0)
    assert least is not None
    np.testing.assert_allclose(least[1:], feet[1:, 2] - ROUGH.slip_m)
    assert least[0] == -np.inf


def walked(scenario: Scenario, length_m: float) -> tuple[bool, float]:
    """Whether a robot on a straight walk stayed up, and how far it is from the end then."""
    simulator = Simulator()
    simulator.perform(Reset(scenario=scenario, seed=3), with_trace=False)
    start = scenario.start.pose()
    end = start @ Pose2(x_m=length_m, y_m=0.0, yaw_rad=0.0)
    outcome = simulator.perform(Follow(waypoints=(start, end)), with_trace=False)
    n = 0
    while outcome.world.path is not None and not outcome.world.path.done and not outcome.world.fallen:
        outcome = simulator.perform(Walk(), with_trace=False)
        n += 1
        assert n < 20
    return not outcome.world.fallen, float(np.linalg.norm(planar_pose(outcome.world.trunk).xy() - end.xy()))


@pytest.mark.parametrize("edge_m", [0.98, 1.1])
def test_a_robot_walks_up_a_step_of_8_cm(at_the_box: Scenario, monkeypatch: pytest.MonkeyPatch, edge_m: float) -> None:
    lay_tile(monkeypatch, np.array([2.0 + edge_m + 2.0, 3.0]), 0.08, side_m=4.0)
    stayed_up, off_m = walked(replace(at_the_box, start=PoseDeg(x_m=2.0, y_m=3.0, yaw_deg=0.0)), 1.5)
    assert stayed_up
    assert off_m < 0.06


def test_a_robot_walks_over_tiles_of_up_to_5_cm(at_the_box: Scenario) -> None:
    tiles = Realism(floor=FloorTiles(height_m=0.05, size_m=0.25))
    scenario = replace(at_the_box, start=PoseDeg(x_m=2.0, y_m=3.0, yaw_deg=0.0), realism=tiles)
    stayed_up, off_m = walked(scenario, 1.2)
    assert stayed_up
    assert off_m < 0.04


@pytest.mark.parametrize("uphill_deg", [70.0, 200.0])
def test_a_robot_that_is_not_told_a_slope_of_10_degrees_walks_on_it(at_the_box: Scenario, uphill_deg: float) -> None:
    slope = Realism(slope_deg=10.0, uphill_deg=uphill_deg)
    stayed_up, off_m = walked(replace(at_the_box, start=PoseDeg(x_m=2.0, y_m=3.0, yaw_deg=0.0), realism=slope), 0.8)
    assert stayed_up
    assert off_m < 0.12
