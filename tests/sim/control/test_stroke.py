"""The stroke that pushes a heavy box."""

import numpy as np
import pytest

from sim_proc.control.stroke import heavy_force, heavy_ticks, heavy_way
from tests.robots import ROBOT

MOTION = ROBOT.pushing


def test_the_foot_rests_at_the_box_presses_it_ahead_and_stays() -> None:
    way = heavy_way(MOTION, 0.6)
    assert len(way) == heavy_ticks(MOTION)
    assert way[MOTION.approach_ticks - 1] == pytest.approx(0.6)
    assert (np.diff(way) >= 0.0).all()
    np.testing.assert_array_equal(way[-MOTION.unload_ticks - 1 :], 1.0)
    assert np.diff(way)[MOTION.approach_ticks - 1] < 0.001


def test_the_force_acts_only_while_the_foot_presses_and_goes_while_it_stays() -> None:
    force = heavy_force(MOTION)
    assert len(force) == heavy_ticks(MOTION)
    assert not force[: MOTION.approach_ticks].any()
    pressing = force[MOTION.approach_ticks : -MOTION.unload_ticks]
    assert pressing[len(pressing) // 2 :].min() == 1.0
    assert (np.diff(force[-MOTION.unload_ticks - 1 :]) < 0.0).all()
    assert force[-1] == 0.0
    assert np.abs(np.diff(force)).max() < 0.2
