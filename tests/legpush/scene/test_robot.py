"""The record of the robot: what follows from its numbers, and which numbers do not fit together."""

from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.messages import codec
from legpush.scene.conventions import JOINTS, LEGS
from legpush.scene.robot import RobotSpec
from tests.robots import ROBOT, scaled_robot


def test_feet_stand_at_the_corners_of_their_rectangle_in_the_order_of_the_legs() -> None:
    corners = ROBOT.stance.foot_rectangle_b()
    feet = dict(zip(LEGS, corners, strict=True))
    assert all((x > 0.0) == (leg[0] == "F") and (y > 0.0) == (leg[1] == "L") for leg, (x, y) in feet.items())
    assert np.hypot(*corners.T) == pytest.approx(ROBOT.stance.foot_circle_m)


def test_the_joints_have_the_fields_of_their_names() -> None:
    assert tuple(getattr(ROBOT.joints, name) for name in JOINTS) == ROBOT.joints.in_order()


def test_the_robot_weighs_as_much_as_spot() -> None:
    assert ROBOT.mass_kg == pytest.approx(31.84)


@pytest.mark.parametrize(
    ("below_m", "turn_deg", "ahead_m"),
    [(0.0, 0.0, 0.3619), (0.08, 0.0, 0.35), (0.2, 0.0, 0.0), (0.08, 10.0, 0.3638), (0.08, -10.0, 0.3638)],
)
def test_the_trunk_reaches_ahead_as_far_as_its_parts_at_that_height(
    below_m: float, turn_deg: float, ahead_m: float
) -> None:
    assert ROBOT.trunk.ahead_m(below_m, np.radians(turn_deg)) == pytest.approx(ahead_m, abs=1e-4)


@given(st.floats(0.2, 3.0))
def test_what_follows_from_the_numbers_scales_with_the_robot(scale: float) -> None:
    robot = scaled_robot(scale)
    for length in ("station_m", "touchdown_m", "fall_height_m"):
        assert getattr(robot, length) == pytest.approx(scale * getattr(ROBOT, length))
    assert robot.stance.foot_circle_m == pytest.approx(scale * ROBOT.stance.foot_circle_m)
    assert robot.stance.com_height_m == pytest.approx(scale * ROBOT.stance.com_height_m)
    assert robot.mass_kg == pytest.approx(scale**3 * ROBOT.mass_kg)


def test_a_table_may_state_a_single_number() -> None:
    robot = codec.convert({"joints": {"knee": {"max_torque_n_m": 60.0}}, "gait": {"stride_m": 0.3}}, RobotSpec)
    knee = robot.joints.knee
    assert (knee.max_torque_n_m, knee.min_deg, knee.max_deg) == (60.0, 15.0, 130.0)
    assert (robot.gait.stride_m, robot.gait.max_step_m) == (0.3, ROBOT.gait.max_step_m)
    assert robot.legs == ROBOT.legs


@pytest.mark.parametrize(
    ("table", "text"),
    [
        ({"joints": {"knee": {"min_deg": 50.0, "max_deg": 40.0}}}, "Expected min_deg < max_deg, got 50 and 40"),
        ({"joints": {"hip_y": {"min_deg": 20.0, "max_deg": 20.0}}}, "Expected min_deg < max_deg, got 20 and 20"),
        ({"joints": {"hip_y": {"min_deg": 60.0}}}, "Expected joints.hip_y from 60 to 100° in the stance, got 52.9°"),
        ({"joints": {"hip_x": {"min_deg": 1.0}}}, "Expected joints.hip_x from 1 to 45° in the stance"),
        ({"stance": {"height_m": 0.8}}, "hip-y axis to the foot within the limits of the knee, got 0.780 m"),
        ({"stance": {"height_m": 0.2}}, "Expected legs that reach the stance: 0.295 to 0.685 m"),
        ({"stance": {"height_m": 0.05, "com_below_trunk_m": 0.0}}, "Expected legs that reach the stance"),
        ({"stance": {"foot_rectangle_width_m": 1.2}}, "Expected legs that reach the stance"),
        ({"stance": {"foot_rectangle_length_m": 2.0}}, "Expected legs that reach the stance"),
        ({"legs": {"hip_offset_m": 0.6}}, "Expected legs that reach the stance"),
        ({"legs": {"foot_radius_m": 0.48}}, "Expected legs.foot_radius_m < stance.height_m, got 0.48 and 0.48"),
        ({"stance": {"com_below_trunk_m": 0.5}}, "Expected com_below_trunk_m < height_m, got 0.5 and 0.48"),
        ({"gait": {"stride_m": 0.5}}, "Expected stride_m <= max_step_m, got 0.5 and 0.48"),
    ],
)
def test_numbers_that_do_not_fit_together_are_refused(table: dict[str, Any], text: str) -> None:
    with pytest.raises(msgspec.ValidationError) as refused:
        msgspec.convert(table, RobotSpec)
    assert text in str(refused.value)
