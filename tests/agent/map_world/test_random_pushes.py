"""Series of random pushes, measured in a world without physics."""

import threading

import numpy as np
import pytest

from agent_proc.map_world.random_pushes import (
    DEEPEST_M,
    LEAST_DEPTH_M,
    PUSHES_PER_SERIES,
    RandomSeries,
    mean_stance,
    measure_series,
)
from agent_proc.push_model.calibration import CalibrationError
from agent_proc.push_model.model import NOMINAL
from legpush.errors import StopRequestedError
from legpush.messages.stepping import Motion, Push
from legpush.scene.names import Face
from tests.agent.fake_world import FakeWorld
from tests.robots import ROBOT


def test_pushes_cover_legs_depths_and_curves_and_follow_from_the_seed() -> None:
    pushes = [push for seed in range(50) for push in RandomSeries(face="right", seed=seed).pushes()]
    depths = np.array([push.depth_m for push in pushes])
    weights = np.array([(push.w1, push.w2) for push in pushes])

    assert len(pushes) == 50 * PUSHES_PER_SERIES
    assert {push.face for push in pushes} == {"right"}
    assert 0.4 < np.mean([push.leg == "FL" for push in pushes]) < 0.6
    assert LEAST_DEPTH_M <= depths.min() < 0.004 < 0.11 < depths.max() <= DEEPEST_M
    assert 0.15 < (depths < 0.01).mean() < 0.35
    assert np.abs(weights.mean(axis=0) - 0.5).max() < 0.05
    assert abs(np.corrcoef(weights.T)[0, 1]) < 0.1
    assert RandomSeries(face="right", seed=7).pushes() == RandomSeries(face="right", seed=7).pushes()
    assert RandomSeries(face="right", seed=7).pushes() != RandomSeries(face="right", seed=8).pushes()


@pytest.mark.parametrize("face", ["rear", "right"])
def test_displacements_are_those_of_the_pushed_frame(face: Face) -> None:
    found = measure_series(FakeWorld(push_scale=0.5), ROBOT, NOMINAL, RandomSeries(face=face, seed=1))

    assert (found.face, len(found.pushes)) == (face, PUSHES_PER_SERIES)
    for push in found.pushes:
        assert 0.0 <= push.forward_m <= 0.5 * push.depth_m
        assert push.turn_rad * (1.0 if push.leg == "FL" else -1.0) <= 0.0
        assert (push.after.trunk.x_m, push.after.trunk.y_m) == pytest.approx((0.0, 0.0), abs=1e-9)
        assert push.after.tips_m[0][:2] == pytest.approx(ROBOT.stance.foot_rectangle_b()[0])
    assert found.before.trunk.x_m == pytest.approx(0.0, abs=1e-9)


def test_a_fall_ends_a_series_and_a_stop_too() -> None:
    def falls(motion: Motion, n: int) -> bool:
        return isinstance(motion, Push) and n == 3

    series = RandomSeries(face="rear", seed=1)
    with pytest.raises(CalibrationError, match="The robot fell as it pushed the rear face"):
        measure_series(FakeWorld(falls_in=falls), ROBOT, NOMINAL, series)
    stop = threading.Event()
    stop.set()
    with pytest.raises(StopRequestedError):
        measure_series(FakeWorld(), ROBOT, NOMINAL, series, stop)


def test_the_mean_of_equal_stances_is_the_stance() -> None:
    stance = measure_series(FakeWorld(), ROBOT, NOMINAL, RandomSeries(face="rear", seed=1)).before
    mean = mean_stance([stance, stance])

    assert mean.trunk_height_m == pytest.approx(stance.trunk_height_m, abs=1e-6)
    assert np.array(mean.tips_m) == pytest.approx(np.array(stance.tips_m), abs=1e-6)
    assert mean.joint_positions_rad == pytest.approx(stance.joint_positions_rad, abs=1e-6)
