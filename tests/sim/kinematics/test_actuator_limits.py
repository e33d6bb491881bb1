"""What the actuators can do at each angle and speed."""

import numpy as np
import pytest

from sim_proc.kinematics.actuator_limits import ActuatorLimits
from tests.robots import ROBOT

LIMITS = ActuatorLimits(ROBOT)
HIP, KNEE = 0, 2


def upper(joint: int, angle_rad: float, speed_rad_s: float) -> float:
    lower, upper = LIMITS.bounds_n_m(np.full(12, angle_rad), np.full(12, speed_rad_s))
    opposite, _ = LIMITS.bounds_n_m(np.full(12, angle_rad), np.full(12, -speed_rad_s))
    assert opposite[joint] == -upper[joint]
    assert lower[joint] <= 0.0 <= upper[joint]
    return float(upper[joint])


@pytest.mark.parametrize(
    ("joint", "angle_rad", "speed_rad_s", "torque_n_m"),
    [
        (HIP, 0.0, 0.0, 45.0),
        (HIP, 0.0, 10.0, 22.5),
        (HIP, 0.0, 20.0, 0.0),
        (HIP, 0.0, 30.0, 0.0),
        (HIP, 0.0, -30.0, 45.0),
        (KNEE, 1.4436, 0.0, 96.9972),
        (KNEE, 1.4436, 7.0, 48.4986),
        (KNEE, 1.4436, 14.0, 0.0),
        (KNEE, 0.2471, 0.0, 30.6),
        (KNEE, 0.60351, 0.0, 71.2286),
        (KNEE, 2.20737, 0.0, 84.0583),
        (KNEE, 0.2471, -14.0, 30.6),
    ],
)
def test_torques_follow_angle_and_speed_as_measured(
    joint: int, angle_rad: float, speed_rad_s: float, torque_n_m: float
) -> None:
    assert upper(joint, angle_rad, speed_rad_s) == pytest.approx(torque_n_m, abs=1.0)


def test_a_torque_at_the_limit_is_within_it_and_one_above_is_not() -> None:
    angles, speeds = np.full((3, 12), 1.0), np.full((3, 12), 2.0)
    _, most = LIMITS.bounds_n_m(angles, speeds)
    assert not LIMITS.beyond(angles, speeds, most).any()
    assert LIMITS.beyond(angles, speeds, most + 0.01).all()
