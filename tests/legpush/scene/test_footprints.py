"""Distances between rectangles on the floor, and what box and obstacles cover."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given

from legpush.geometry import Pose2
from legpush.scene.footprints import (
    Footprint,
    behind_box,
    box_footprint,
    distance_m,
    distance_to_border_m,
    distance_to_point_m,
    obstacle_footprint,
)
from legpush.scene.scenario import Box, PoseDeg, Rectangle, Room
from tests.legpush.scene.floor_shapes import FOOTPRINT, samples_in


@given(a=FOOTPRINT, b=FOOTPRINT)
def test_the_distance_of_footprints_is_that_of_their_nearest_points(a: Footprint, b: Footprint) -> None:
    distance = distance_m(a, b)
    nearest = min(distance_to_point_m(a, point) for point in samples_in(b))
    spacing = hypot(b.length_m, b.width_m) / 40
    if distance > 0.0:
        assert distance - 1e-9 <= nearest <= distance + spacing
    else:
        assert nearest <= spacing
    assert distance == pytest.approx(distance_m(b, a), abs=1e-9)


@given(a=FOOTPRINT, b=FOOTPRINT)
def test_footprints_that_overlap_part_when_moved_by_what_the_distance_says(a: Footprint, b: Footprint) -> None:
    depth = -distance_m(a, b)
    if depth <= 0.0:
        return
    ways = [f.pose.yaw_rad + quarter * pi / 2 for f in (a, b) for quarter in range(4)]
    moved = [
        Footprint(
            pose=Pose2(x_m=b.pose.x_m + depth * cos(way), y_m=b.pose.y_m + depth * sin(way), yaw_rad=b.pose.yaw_rad),
            length_m=b.length_m,
            width_m=b.width_m,
        )
        for way in ways
    ]
    assert max(distance_m(a, m) for m in moved) == pytest.approx(0.0, abs=1e-9)


def test_an_obstacle_and_its_footprint_are_the_same_rectangle() -> None:
    wall = Rectangle(x_min_m=1.0, x_max_m=3.0, y_min_m=2.0, y_max_m=2.5)
    assert obstacle_footprint(wall).corners().tolist() == [[3.0, 2.5], [1.0, 2.5], [1.0, 2.0], [3.0, 2.0]]


BOX = Box(size_m=(0.4, 0.6, 0.4), pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0))
AT = Pose2(x_m=2.0, y_m=1.0, yaw_rad=pi / 2)


def test_the_box_covers_its_length_along_its_heading() -> None:
    np.testing.assert_allclose(box_footprint(BOX, AT).corners(), [[1.7, 1.2], [1.7, 0.8], [2.3, 0.8], [2.3, 1.2]])


def test_behind_the_box_is_behind_its_rear_face_with_its_heading() -> None:
    behind = behind_box(BOX, AT, 0.5)
    np.testing.assert_allclose(behind.xy(), [2.0, 1.0 - 0.2 - 0.5])
    assert behind.yaw_rad == AT.yaw_rad


@pytest.mark.parametrize(
    ("points", "distance"), [([[1.0, 2.0], [3.9, 2.0]], 0.1), ([[1.0, 2.5]], 0.5), ([[1.0, 1.0], [1.0, 3.2]], -0.2)]
)
def test_the_border_of_a_room_is_as_far_as_its_nearest_point(points: list[list[float]], distance: float) -> None:
    room = Room(size_m=(4.0, 3.0), obstacles=())
    assert distance_to_border_m(np.array(points), room) == pytest.approx(distance)
