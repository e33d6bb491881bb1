"""Records of a scenario refuse what cannot be."""

from math import pi

import msgspec
import pytest

from legpush.scene.scenario import Box, BoxShape, PoseDeg, Rectangle

ORIGIN = PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0)


def test_a_pose_in_degrees_is_the_same_in_radians() -> None:
    pose = PoseDeg(x_m=1.0, y_m=2.0, yaw_deg=270.0).pose()
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((1.0, 2.0, 3 * pi / 2))


@pytest.mark.parametrize("sides", [(2.0, 2.0, 0.0, 1.0), (0.0, 1.0, 3.0, 2.0)])
def test_a_rectangle_without_an_area_is_refused(sides: tuple[float, float, float, float]) -> None:
    fields = dict(zip(("x_min_m", "x_max_m", "y_min_m", "y_max_m"), sides, strict=True))
    with pytest.raises(msgspec.ValidationError, match="max_m"):
        msgspec.convert(fields, Rectangle)


@pytest.mark.parametrize("shape", ["cylinder", "wedge", "l_shape"])
def test_a_box_of_any_shape_can_be_made(shape: BoxShape) -> None:
    assert Box(pose=ORIGIN, size_m=(0.4, 0.4, 0.4), shape=shape).shape == shape


def test_a_cylinder_that_is_no_circle_is_refused() -> None:
    with pytest.raises(ValueError, match="size_m"):
        Box(pose=ORIGIN, size_m=(0.4, 0.5, 0.4), shape="cylinder")
