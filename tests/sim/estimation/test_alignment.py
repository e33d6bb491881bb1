"""The beginning of an estimate, from sensors of a robot that stands still."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from legpush.geometry import Pose2
from sim_proc.estimation import layout, motion
from sim_proc.estimation.alignment import aligned
from sim_proc.estimation.body import standing_height_m
from sim_proc.estimation.readings import ACCELERATION, GYRO
from tests.sim.estimation.standing import GRAVITY, ROBOT, body, still

START = Pose2(x_m=1.0, y_m=2.0, yaw_rad=2.5)


def attitude(state: np.ndarray) -> Rotation:
    return Rotation.from_quat(state[layout.QUATERNION : layout.QUATERNION + 4], scalar_first=True)


@pytest.mark.parametrize("yaw_rad", [0.0, 2.5, -3.1])
def test_a_leaning_trunk_is_found_with_its_feet_on_the_floor(yaw_rad: float) -> None:
    lean = Rotation.from_euler("YX", [0.05, -0.03])
    begin, gravity = aligned(body(), Pose2(x_m=1.0, y_m=2.0, yaw_rad=yaw_rad), still(attitude=lean))
    assert (gravity == GRAVITY).all()
    found = attitude(begin.state)
    wanted = Rotation.from_euler("Z", yaw_rad) * lean
    heading = np.arctan2(*wanted.as_matrix()[1::-1, 0])
    assert (Rotation.from_euler("Z", yaw_rad - heading) * wanted * found.inv()).magnitude() < 1e-9
    assert begin.state[:2].tolist() == [1.0, 2.0]
    assert begin.state[layout.FEET + 2 :: 3] == pytest.approx(standing_height_m(ROBOT))
    assert begin.state[layout.GYRO_BIAS : layout.FEET] == pytest.approx(0.0, abs=1e-12)


def test_biases_are_those_that_a_robot_at_rest_reads() -> None:
    readings = still()
    readings[:, GYRO] += [0.001, -0.002, 0.003]
    readings[:, ACCELERATION] += [0.05, -0.03, 0.02]
    state = aligned(body(), START, readings)[0].state
    assert state[layout.GYRO_BIAS : layout.ACCELERATION_BIAS] == pytest.approx([0.001, -0.002, 0.003])
    # A twelfth of what looks like a lean is believed to be one.
    assert state[layout.ACCELERATION_BIAS : layout.FEET] == pytest.approx([0.05, -0.03, 0.02], rel=0.1)
    assert np.abs(attitude(state).as_euler("xyz")[:2]).max() == pytest.approx(0.05 / 9.81 / 12, rel=0.1)


@pytest.mark.parametrize("turned_rad", [0.0, 0.0006, 0.004])
def test_a_robot_that_still_settles_does_not_take_its_turn_for_a_bias(turned_rad: float) -> None:
    axis, n, bias = np.array([0.6, -0.8, 0.3]), 150, np.array([0.001, -0.002, 0.003])
    left = turned_rad * (1.0 - np.arange(n) / (n - 1)) ** 2
    rows = [still(1, attitude=Rotation.from_rotvec(-angle * axis)) for angle in left]
    readings = np.concatenate(rows)
    readings[:, GYRO] += bias - np.gradient(left, layout.STEP_S)[:, None] * axis
    state = aligned(body(), START, readings)[0].state
    # A turn that is less than what noise of the joint angles may tell is not looked at.
    believed = turned_rad / (n * layout.STEP_S) if turned_rad < 0.001 else 0.0
    assert state[layout.GYRO_BIAS : layout.ACCELERATION_BIAS] == pytest.approx(bias + believed * axis, abs=1e-4)
    assert np.abs(attitude(state).as_euler("xyz")[:2]).max() < max(turned_rad / 20, 1e-9 + turned_rad * (believed > 0))


def test_a_known_slope_is_no_bias() -> None:
    gravity = Rotation.from_euler("y", 0.1).apply(GRAVITY)
    heading = Rotation.from_euler("z", START.yaw_rad)
    readings = still(gravity=heading.inv().apply(gravity))
    state = aligned(body(gravity), START, readings)[0].state
    assert attitude(state).magnitude() == pytest.approx(START.yaw_rad)
    assert state[layout.ACCELERATION_BIAS : layout.FEET] == pytest.approx(0.0, abs=1e-12)


def test_a_slope_that_nobody_knew_is_found_by_gravity_and_the_attitude_is_that_to_the_floor() -> None:
    hidden = Rotation.from_euler("y", 0.06).apply(GRAVITY)
    heading = Rotation.from_euler("z", START.yaw_rad)
    begin, gravity = aligned(body(), START, still(gravity=heading.inv().apply(hidden)))
    assert gravity == pytest.approx(hidden)
    assert attitude(begin.state).magnitude() == pytest.approx(START.yaw_rad)
    assert begin.state[layout.ACCELERATION_BIAS : layout.FEET] == pytest.approx(0.0, abs=1e-12)


def test_the_beginning_changes_nothing_that_it_was_given() -> None:
    readings, numbers = still(), body()
    readings.flags.writeable = numbers.flags.writeable = False
    begin, _ = aligned(numbers, START, readings)
    assert (np.diag(begin.covariance) > 0.0).all()
    tips, com = np.empty((4, 3)), np.empty(3)
    motion.kinematics.py_func(numbers, begin.memory[layout.JOINTS : layout.JOINTS + 12], tips, com)
    assert com.tolist() == [0.0, 0.0, 0.0]
