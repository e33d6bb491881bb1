"""Feet that stand, slip, are lifted and tared."""

from typing import Any

import numpy as np
import pytest

from legpush.geometry import Pose2
from sim_proc.estimation import kernel, layout
from sim_proc.estimation.alignment import aligned
from sim_proc.estimation.readings import FORCES, GYRO, JOINTS
from tests.sim.estimation.standing import body, still

START = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)


class Robot:
    """A robot that stands still, whose readings a test changes."""

    def __init__(self) -> None:
        self.arrays = aligned(body(), START, still())

    def advance(self, n: int, lifted: int | None = None, **changes: Any) -> Any:
        """Estimates after n ticks, (n, N_OUT)."""
        readings = still(n * layout.STEPS).reshape(n, layout.STEPS, -1)
        for name, value in changes.items():
            readings[..., {"gyro": GYRO, "joints": JOINTS, "forces": FORCES}[name]] += value
        up, out = np.zeros((n, 4), dtype=np.bool_), np.empty((n, layout.N_OUT))
        if lifted is not None:
            up[:, lifted] = True
        kernel.advance(*self.arrays, body(), readings, up, out)
        return out

    @property
    def down(self) -> list[float]:
        found: list[float] = self.arrays.memory[layout.DOWN : layout.DOWN + 4].tolist()
        return found

    @property
    def tare_n(self) -> Any:
        return self.arrays.memory[layout.TARE : layout.TARE + 4]


def test_a_robot_at_rest_stays_where_it_is() -> None:
    robot = Robot()
    before = robot.arrays.state.copy()
    out = robot.advance(100)
    assert robot.arrays.state == pytest.approx(before, abs=1e-9)
    assert out[-1, layout.OUT_LOADS : layout.OUT_COM] == pytest.approx([75.0] * 4)
    assert np.abs(out[:, layout.OUT_COM_VELOCITY : layout.OUT_JOINTS]).max() < 1e-9
    assert np.linalg.eigvalsh(robot.arrays.covariance).min() > 0.0


def test_gravity_and_standing_feet_show_the_bias_of_the_gyroscope_but_of_the_heading() -> None:
    robot = Robot()
    out = robot.advance(1500, gyro=[0.0005, -0.0005, 0.0])
    biases = robot.arrays.state[layout.GYRO_BIAS : layout.ACCELERATION_BIAS]
    assert biases == pytest.approx([0.0005, -0.0005, 0.0], rel=0.1, abs=1e-6)
    assert np.abs(out[-1, layout.OUT_ROTATION + 6 : layout.OUT_ROTATION + 8]).max() < 0.0015


def test_a_foot_is_up_below_one_force_and_down_above_another() -> None:
    robot = Robot()
    robot.advance(1, forces=[55.0, 0.0, 0.0, 0.0])
    assert robot.down == [3.0] * 4
    robot.advance(1, forces=[65.0, 0.0, 0.0, 0.0])
    assert robot.down == [0.0, 3.0, 3.0, 3.0]
    robot.advance(1, forces=[55.0, 0.0, 0.0, 0.0])
    assert robot.down == [0.0, 3.0, 3.0, 3.0]
    robot.advance(2, forces=[40.0, 0.0, 0.0, 0.0])
    assert robot.down == [2.0, 3.0, 3.0, 3.0]
    robot.advance(1)
    assert robot.down == [3.0] * 4


def test_a_lifted_foot_is_tared_in_the_middle_of_its_flight_unless_it_touches_something() -> None:
    robot = Robot()
    robot.advance(3, lifted=1, forces=[0.0, 75.0 - 14.0, 0.0, 0.0])
    assert robot.tare_n.tolist() == [0.0] * 4
    out = robot.advance(4, lifted=1, forces=[0.0, 75.0 - 14.0, 0.0, 0.0])
    assert robot.tare_n == pytest.approx([0.0, 14.0, 0.0, 0.0])
    assert out[-1, layout.OUT_LOADS + 1] == pytest.approx(0.0, abs=1e-9)
    other = Robot()
    other.advance(8, lifted=1)
    assert other.tare_n.tolist() == [0.0] * 4
    assert other.down == [3.0, 0.0, 3.0, 3.0]


def test_a_foot_that_slips_stands_in_a_new_place_and_takes_the_robot_nowhere() -> None:
    robot = Robot()
    turned = np.zeros(12)
    turned[1] = 0.3
    before = robot.arrays.state[:3].copy()
    out = robot.advance(5, joints=turned)
    assert robot.down == [3.0] * 4
    assert robot.arrays.state[:3] == pytest.approx(before, abs=5e-3)
    foot = robot.arrays.state[layout.FEET : layout.FEET + 3]
    assert foot == pytest.approx(out[-1, layout.OUT_TIPS : layout.OUT_TIPS + 3], abs=2e-3)


def test_heights_of_footholds_pull_the_robot_to_the_floor() -> None:
    robot = Robot()
    robot.arrays.state[2] += 0.01
    robot.arrays.state[layout.FEET + 2 :: 3] += 0.01
    for leg in range(4):
        up = np.zeros(4)
        up[leg] = 75.0
        robot.advance(3, forces=up)
        robot.advance(3)
    assert robot.arrays.state[layout.FEET + 2] - body()[layout.FLOOR_HEIGHT] == pytest.approx(0.01 * 0.9**4, rel=0.02)
