"""Faces of the box: the frame that is pushed, and the size of the box in it."""

from math import pi

import pytest

from legpush.geometry import Pose2
from legpush.scene.faces import FACES, PUSHABLE, TURN_RAD, pushed_box, pushed_pose
from legpush.scene.scenario import Box, Face, PoseDeg

POSE = Pose2(x_m=1.0, y_m=2.0, yaw_rad=0.3)
BOX = Box(size_m=(0.4, 0.5, 0.3), pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0))


@pytest.mark.parametrize(("face", "turn_rad"), [("rear", 0.0), ("right", pi / 2), ("front", pi), ("left", -pi / 2)])
def test_a_push_on_a_face_moves_the_box_away_from_it(face: Face, turn_rad: float) -> None:
    pushed = pushed_pose(POSE, face)
    assert (pushed.x_m, pushed.y_m) == pytest.approx((POSE.x_m, POSE.y_m))
    assert (pushed @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=-turn_rad)).yaw_rad == pytest.approx(POSE.yaw_rad)


@pytest.mark.parametrize(("face", "size_m"), [("rear", (0.4, 0.5)), ("front", (0.4, 0.5)), ("left", (0.5, 0.4))])
def test_seen_from_the_side_length_and_width_change_places(face: Face, size_m: tuple[float, float]) -> None:
    assert pushed_box(BOX, face).size_m == (*size_m, 0.3)


def test_every_shape_can_be_pushed_at_its_rear_face() -> None:
    assert TURN_RAD.keys() == set(FACES)
    assert all("rear" in faces and set(faces) <= set(FACES) for faces in PUSHABLE.values())
