"""Shortest forward paths, compared with circles and lines."""

from math import hypot, pi

import numpy as np
import pytest

from legpush.geometry import wrap_angle
from planner_proc.box.dubins import SAMPLE_M, Dubins
from tests.planner.maps import pose

RADIUS_M = 0.7


def test_straight_ahead_is_a_line_and_the_opposite_heading_beside_it_half_a_circle() -> None:
    dubins = Dubins(RADIUS_M)

    assert dubins.length_m(pose(0.0, 0.0), pose(2.0, 0.0)) == pytest.approx(2.0)
    assert dubins.length_m(pose(0.0, 0.0), pose(0.0, 2 * RADIUS_M, pi)) == pytest.approx(pi * RADIUS_M)
    assert dubins.length_m(pose(0.0, 0.0), pose(-0.5, 0.0)) > 2 * pi * RADIUS_M


@pytest.mark.parametrize("seed", range(5))
def test_samples_lead_forward_from_end_to_end_and_turn_no_tighter_than_the_radius(seed: int) -> None:
    random = np.random.default_rng(seed)
    a, b = (pose(*random.uniform([-2.0, -2.0, -pi], [2.0, 2.0, pi]).tolist()) for _ in range(2))
    dubins = Dubins(RADIUS_M)

    poses = dubins.poses(a, b)

    ends = np.array([[*each.xy(), each.yaw_rad] for each in (a, b)])
    np.testing.assert_allclose(poses[[0, -1], :2], ends[:, :2], atol=1e-6)
    np.testing.assert_allclose(np.cos(poses[[0, -1], 2] - ends[:, 2]), 1.0, atol=1e-6)
    steps = np.diff(poses[:, :2], axis=0)
    lengths_m = np.hypot(*steps.T)
    turns = np.abs([wrap_angle(turn) for turn in np.diff(poses[:, 2]).tolist()])
    assert lengths_m.max() <= SAMPLE_M + 1e-9
    assert (turns <= SAMPLE_M / RADIUS_M + 1e-6).all()
    assert ((steps * np.stack([np.cos(poses[:-1, 2]), np.sin(poses[:-1, 2])], axis=1)).sum(axis=1) > 0.0).all()
    assert lengths_m.sum() == pytest.approx(dubins.length_m(a, b), rel=1e-3)


def test_a_pose_along_a_path_has_the_distance_behind_it_and_the_rest_before_it() -> None:
    dubins = Dubins(RADIUS_M)
    a, b = pose(0.0, 0.0, 1.0), pose(1.5, -1.0, 0.2)
    length_m = dubins.length_m(a, b)

    middle = dubins.along(a, b, 0.4 * length_m)

    assert dubins.length_m(a, middle) == pytest.approx(0.4 * length_m)
    assert dubins.length_m(middle, b) == pytest.approx(0.6 * length_m)
    assert dubins.along(a, b, length_m + 1.0) == b
    start = dubins.along(a, b, 0.0)
    assert hypot(start.x_m - a.x_m, start.y_m - a.y_m) == pytest.approx(0.0, abs=1e-9)
