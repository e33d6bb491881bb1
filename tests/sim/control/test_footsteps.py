"""Footsteps along a path."""

from itertools import pairwise
from math import cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import LinearRing

from legpush.geometry import Pose2
from legpush.scene.conventions import LEGS
from sim_proc.control.footsteps import (
    ADVANCES,
    GAIT_ORDER,
    STRIDE_SHARES,
    PosePath,
    longest_stride_m,
    narrowest_m,
    next_cycle,
)
from tests.robots import CIRCLE_M, ROBOT

APART_M = 0.1
"""More than the diameter of a foot."""


def pose(x: float, y: float, yaw: float) -> Pose2:
    return Pose2(x_m=x, y_m=y, yaw_rad=yaw)


def walk_to_the_end(path: PosePath) -> list[np.ndarray]:
    travelled, feet = np.zeros(4), path.corners(np.zeros(4))
    cycles = [travelled]
    while (travelled < path.length_m).any():
        targets = next_cycle(path, travelled, feet)
        steps = np.linalg.norm(targets.feet_m - feet, axis=1)
        assert steps.max() <= ROBOT.gait.max_step_m + 1e-9
        assert targets.travelled_m.mean() > travelled.mean()
        turn = path.poses(targets.travelled_m.mean())[2] - path.poses(travelled.mean())[2]
        assert abs(turn) <= ROBOT.gait.max_turn_rad + 1e-9
        travelled, feet = targets.travelled_m, targets.feet_m
        cycles.append(travelled)
        assert len(cycles) < 200
    return cycles


def test_a_path_counts_turns_by_the_arc_of_the_feet() -> None:
    path = PosePath(ROBOT, [pose(0, 0, 0), pose(2, 0, 0), pose(2, 0, pi / 2)])
    assert path.length_m == pytest.approx(2 + CIRCLE_M * pi / 2)
    np.testing.assert_allclose(path.poses(np.array(1.0)), [1, 0, 0])
    np.testing.assert_allclose(path.poses(np.array(99.0)), [2, 0, pi / 2])


def test_a_path_turns_the_short_way_round() -> None:
    path = PosePath(ROBOT, [pose(0, 0, pi - 0.1), pose(0, 0, -pi + 0.1)])
    assert path.length_m == pytest.approx(0.2 * CIRCLE_M)


def test_the_feet_end_at_the_corners_of_the_last_rectangle() -> None:
    path = PosePath(ROBOT, [pose(0, 0, 0), pose(3, 0, 0)])
    last = walk_to_the_end(path)[-1]
    np.testing.assert_allclose(path.corners(last), ROBOT.stance.foot_rectangle_b() + np.array([3, 0]))


def test_in_the_middle_of_a_straight_path_every_cycle_advances_by_the_stride() -> None:
    travelled = walk_to_the_end(PosePath(ROBOT, [pose(0, 0, 0), pose(6, 0, 0)]))
    advances = np.diff([t.mean() for t in travelled])
    assert (np.abs(advances[3:-3] - ROBOT.gait.stride_m) < 1e-9).all()
    assert len(advances) > 10


@given(st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.floats(-pi, pi)), min_size=2, max_size=6))
def test_any_path_is_walked_to_its_end_within_the_limits_of_a_step(waypoints: list[tuple[float, float, float]]) -> None:
    path = PosePath(ROBOT, [pose(*waypoint) for waypoint in waypoints])
    assert (walk_to_the_end(path)[-1] == path.length_m).all()


@given(
    direction_deg=st.floats(-180.0, 180.0),
    heading_rad=st.floats(-pi, pi),
    turn_rad=st.floats(-1.0, 1.0),
    length_m=st.floats(0.3, 3.0),
)
def test_a_path_that_leads_sideways_is_walked_with_short_strides(
    direction_deg: float, heading_rad: float, turn_rad: float, length_m: float
) -> None:
    """The robot may also turn on the way: the direction counts from its heading half way of each cycle."""
    along = heading_rad + radians(direction_deg)
    waypoints = [
        pose(share * length_m * cos(along), share * length_m * sin(along), heading_rad + share * turn_rad)
        for share in np.linspace(0.0, 1.0, 40)
    ]
    path = PosePath(ROBOT, waypoints)
    means = [travelled.mean() for travelled in walk_to_the_end(path)]
    for before, after in pairwise(path.poses(np.array(means))):
        moved = (after - before)[None]
        limit_m = longest_stride_m(ROBOT.gait, moved, before[2])[0]
        least_m = ROBOT.gait.stride_m * ADVANCES[-1]
        assert np.hypot(*moved[0, :2]) <= max(limit_m, least_m) + 1e-5


def test_the_longest_stride_is_that_of_the_table_and_equal_to_both_sides() -> None:
    for direction_deg, share in STRIDE_SHARES:
        for sign in (1.0, -1.0):
            along = sign * radians(direction_deg)
            moved = np.array([[cos(along), sin(along), 0.0]])
            assert longest_stride_m(ROBOT.gait, moved, 0.0)[0] == pytest.approx(share * ROBOT.gait.stride_m)


@given(
    ahead_m=st.floats(0.0, 0.5),
    first_rad=st.floats(-pi, pi),
    other_rad=st.floats(-pi, pi),
    n_cycles=st.integers(1, 5),
)
def test_the_feet_keep_apart_where_another_path_takes_the_place_of_a_turn(
    ahead_m: float, first_rad: float, other_rad: float, n_cycles: int
) -> None:
    ahead = pose(ahead_m, 0.0, 0.0)
    path = PosePath(ROBOT, [pose(0.0, 0.0, 0.0), ahead, ahead @ pose(0.0, 0.0, first_rad)])
    travelled, feet = np.zeros(4), path.corners(np.zeros(4))
    for _ in range(n_cycles):
        targets = next_cycle(path, travelled, feet)
        travelled, feet = targets.travelled_m, targets.feet_m
    here = pose(*path.poses(travelled.mean()).tolist())
    path, travelled = PosePath(ROBOT, [here, here @ pose(0.0, 0.0, other_rad)]), np.zeros(4)
    while (travelled < path.length_m).any():
        targets = next_cycle(path, travelled, feet)
        for leg in GAIT_ORDER:
            feet = feet.copy()
            feet[LEGS.index(leg)] = targets.feet_m[LEGS.index(leg)]
            stand = LinearRing(feet[[LEGS.index(leg) for leg in ("FL", "RL", "RR", "FR")]])
            assert stand.is_simple
            assert stand.is_ccw
            for left, right in (("FL", "FR"), ("RL", "RR")):
                beside_m = np.linalg.norm(feet[LEGS.index(left)] - feet[LEGS.index(right)])
                assert beside_m >= APART_M
        travelled = targets.travelled_m


def test_the_narrowest_stand_is_that_of_the_feet_that_stepped_so_far() -> None:
    feet = ROBOT.stance.foot_rectangle_b()
    inward, across = feet.copy(), feet.copy()
    inward[LEGS.index("FR"), 1] += 0.1
    across[LEGS.index("FR")] = feet[LEGS.index("FL")] + [0.0, 0.05]
    width = ROBOT.stance.foot_rectangle_width_m
    narrowest = narrowest_m(feet, np.array([feet, inward, across]))
    assert narrowest[0] == pytest.approx(width)
    assert 0.9 * (width - 0.1) < narrowest[1] < width - 0.1 + 1e-9
    assert narrowest[2] < 0.0
