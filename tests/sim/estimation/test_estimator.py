"""The estimator, tick by tick."""

import numpy as np
import pytest

from legpush.geometry import Pose2
from sim_proc.estimation import layout
from sim_proc.estimation.estimator import Estimator
from sim_proc.estimation.readings import ACCELERATION, FORCES, GYRO
from tests.sim.estimation.standing import GRAVITY, body, still

START = Pose2(x_m=1.0, y_m=2.0, yaw_rad=0.5)


def disturbed(n: int) -> np.ndarray:
    readings = still(n * layout.STEPS)
    random = np.random.default_rng(0)
    readings[:, GYRO] += random.normal(scale=0.02, size=(len(readings), 3))
    readings[:, ACCELERATION] += random.normal(scale=0.3, size=(len(readings), 3))
    readings[:, FORCES] += random.normal(scale=20.0, size=(len(readings), 4))
    return readings.reshape(n, layout.STEPS, -1)


def test_ticks_can_be_taken_one_by_one_or_together() -> None:
    readings, lifted = disturbed(40), np.random.default_rng(1).random((40, 4)) < 0.1
    found = []
    for parts in ([40], [1] * 40, [3, 17, 20]):
        estimator, tick = Estimator(body(), START, still(), late_steps=11), 0
        for n in parts:
            estimator.advance(readings[tick : tick + n], lifted[tick : tick + n])
            tick += n
        found.append(estimator.as_bytes())
    assert found[0] == found[1] == found[2]


def test_it_begins_where_it_is_told_to_stand() -> None:
    estimator = Estimator(body(), START, still(), late_steps=1)
    state = estimator.state()
    assert state.position_m[:2] == pytest.approx([1.0, 2.0], abs=1e-9)
    assert np.arctan2(state.rotation[1, 0], state.rotation[0, 0]) == pytest.approx(0.5)
    assert state.tips_m[:, 2] == pytest.approx(body()[layout.FLOOR_HEIGHT], abs=1e-9)
    assert estimator.trunk_poses() == pytest.approx(np.array([[1.0, 2.0, 0.5]]), abs=1e-9)
    assert estimator.joints_rad() == pytest.approx(still()[0, 6:18])
    assert estimator.tare_n.tolist() == [0.0] * 4


def test_the_plumb_line_is_that_of_the_scenario_or_of_a_slope_that_nobody_knew() -> None:
    known = np.array([0.8, -0.3, -9.7])
    estimator = Estimator(body(known), Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), still(gravity=known), late_steps=1)
    assert estimator.downhill.tolist() == (known[:2] / 9.7).tolist()
    unknown = Estimator(body(), Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), still(gravity=known), late_steps=1)
    assert unknown.downhill == pytest.approx(known[:2] / 9.7)


def test_what_moves_evenly_is_told_for_the_present() -> None:
    late, early = (Estimator(body(), START, still(), late_steps=steps) for steps in (11, 0))
    readings = still(5 * layout.STEPS)
    readings[:, GYRO] += [0.0, 0.0, 0.2]
    readings[:, ACCELERATION] = -GRAVITY + [1.0, 0.0, 0.0]
    for estimator in (late, early):
        estimator.advance(readings.reshape(5, layout.STEPS, -1), np.ones((5, 4), dtype=np.bool_))
    now, then = late.state(), early.state()
    assert now.position_m == pytest.approx(then.position_m + 0.022 * then.velocity_m_s)
    assert now.com_m == pytest.approx(then.com_m + 0.022 * then.com_velocity_m_s)
    assert now.rotation @ now.rotation.T == pytest.approx(np.eye(3), abs=1e-7)
    assert late.trunk_poses()[-1, 2] - early.trunk_poses()[-1, 2] == pytest.approx(0.022 * 0.2)
    assert (now.tips_m == then.tips_m).all()
