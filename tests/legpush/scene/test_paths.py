"""Lengths of paths, and distances from polylines."""

from math import hypot, pi, tau

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.paths import arc_lengths_m, distances_m, nearest_on_segments, path_length_m, poses_along, travelled_m
from tests.robots import CIRCLE_M

COORDINATES = st.integers(-20_000, 20_000).map(lambda mm: mm / 1000)
"""Whole millimetres: shapely squares lengths, and the square of a tiny one is 0."""


def points(least: int) -> st.SearchStrategy[Floats]:
    """Points on the floor, (n, 2) with n >= `least`."""
    return st.integers(least, 8).flatmap(lambda n: arrays(np.float64, (n, 2), elements=COORDINATES))


def poses(*values: tuple[float, float, float]) -> list[Pose2]:
    return [Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad) for x_m, y_m, yaw_rad in values]


def test_a_turn_on_the_spot_is_as_long_as_the_arc_of_the_feet() -> None:
    way = poses((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), (3.0, 4.0, 1.5), (3.0, 3.0, 1.0))

    at_m = travelled_m(way, CIRCLE_M)

    arc_m = CIRCLE_M
    np.testing.assert_allclose(at_m, [0.0, 5.0, 5.0 + 1.5 * arc_m, 6.0 + 2.0 * arc_m])
    assert path_length_m(way, CIRCLE_M) == at_m[-1]


@pytest.mark.parametrize(("yaw_rad", "turn_rad"), [(0.1 + tau, 0.1), (3.0, 3.0), (2.0 - tau, 2.0), (4.0, tau - 4.0)])
def test_turns_go_the_short_way_round(yaw_rad: float, turn_rad: float) -> None:
    way = poses((1.0, 1.0, 0.0), (1.0, 1.0, yaw_rad))

    assert path_length_m(way, CIRCLE_M) == pytest.approx(turn_rad * CIRCLE_M)


def test_a_pose_that_is_moved_and_turned_counts_both() -> None:
    way = poses((1.0, 1.0, pi - 0.1), (1.3, 1.4, -pi + 0.1))

    assert path_length_m(way, CIRCLE_M) == pytest.approx(0.5 + 0.2 * CIRCLE_M)


def test_a_path_of_one_waypoint_or_none_has_no_length() -> None:
    assert travelled_m(poses((1.0, 2.0, 3.0)), CIRCLE_M).tolist() == [0.0]
    assert path_length_m(poses((1.0, 2.0, 3.0)), CIRCLE_M) == path_length_m([], CIRCLE_M) == 0.0


@given(points(1))
def test_a_polyline_is_as_long_as_its_segments_together(polyline_m: Floats) -> None:
    at_m = arc_lengths_m(polyline_m)

    lengths = [shapely.LineString(polyline_m[: n + 1]).length for n in range(1, len(polyline_m))]
    np.testing.assert_allclose(at_m, [0.0, *lengths])


@given(points(1), points(1))
def test_the_distance_from_a_polyline_is_that_from_its_nearest_point(points_m: Floats, polyline_m: Floats) -> None:
    expected_m = [shapely.Point(point).distance(as_shape(polyline_m)) for point in points_m]

    np.testing.assert_allclose(distances_m(points_m, polyline_m), expected_m, atol=1e-9)


@given(points(1), points(2))
def test_the_nearest_place_on_a_segment_is_as_far_away_as_said(points_m: Floats, polyline_m: Floats) -> None:
    edges_m = np.diff(polyline_m, axis=0)

    shares, distances = nearest_on_segments(points_m, polyline_m, (edges_m**2).sum(axis=1))

    assert shares.shape == distances.shape == (len(points_m), len(edges_m))
    assert (shares >= 0.0).all()
    assert (shares <= 1.0).all()
    for row, point in enumerate(points_m):
        for column, (begin, edge) in enumerate(zip(polyline_m[:-1], edges_m, strict=True)):
            place = begin + shares[row, column] * edge
            expected_m = shapely.Point(point).distance(as_shape(np.array([begin, begin + edge])))
            assert hypot(*(point - place)) == pytest.approx(distances[row, column], abs=1e-9)
            assert distances[row, column] == pytest.approx(expected_m, abs=1e-9)


def as_shape(polyline_m: Floats) -> shapely.Geometry:
    """A polyline for the independent library, in which a line has two different ends."""
    if (polyline_m == polyline_m[0]).all():
        return shapely.Point(polyline_m[0])
    return shapely.LineString(polyline_m)


def test_poses_along_a_path_are_evenly_spaced_by_the_arc_of_the_feet_and_end_with_it() -> None:
    way = poses((0.0, 0.0, 3.0), (1.0, 0.0, 3.0), (1.0, 0.0, -3.0))

    found = poses_along(way, CIRCLE_M, 0.5, 0.1)

    np.testing.assert_allclose([pose.x_m for pose in found[:6]], [0.5, 0.6, 0.7, 0.8, 0.9, 1.0])
    assert (found[-1].x_m, found[-1].yaw_rad) == pytest.approx((1.0, -3.0))
    assert all(abs(pose.yaw_rad) >= 3.0 - 1e-12 for pose in found)
    assert poses_along(way, CIRCLE_M, 99.0, 0.1) == found[-1:]
