"""Loads of the feet: hysteresis, touchdowns and landings, in one motion or in several."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.arrays import Floats
from sim_proc.measures.loads import LoadWatch
from tests.robots import ROBOT, scaled_robot

IN_THE_AIR = [0.0] * 40


def forces(*of_first_foot: float) -> Floats:
    """Forces of the first foot; the others stay in the air."""
    return np.array([[force, 0.0, 0.0, 0.0] for force in of_first_foot])


def heights(n: int, step_m: float = 0.0) -> Floats:
    """Heights of feet that sink by `step_m` in each step."""
    return np.repeat(0.1 - step_m * np.arange(n)[:, None], 4, axis=1)


def test_a_foot_is_loaded_from_15_n_on_until_it_has_less_than_5_n() -> None:
    seen = LoadWatch(ROBOT).take(forces(0.0, 14.0, 16.0, 6.0, 14.0, 4.0, 14.0, 16.0), heights(8))
    assert seen.loaded[:, 0].tolist() == [False, False, True, True, True, False, False, True]
    assert not seen.loaded[:, 1:].any()
    assert seen.n_loadings == 2


def test_thresholds_scale_with_the_weight_of_the_robot() -> None:
    half = scaled_robot(0.5)
    seen = LoadWatch(half).take(forces(1.8, 2.0, 0.7, 0.6), heights(4))
    assert seen.loaded[:, 0].tolist() == [False, True, True, False]


def test_each_rise_above_1_n_is_a_touchdown_but_only_after_a_flight_a_landing() -> None:
    seen = LoadWatch(ROBOT).take(forces(*IN_THE_AIR, 50.0, 0.5, 50.0, *IN_THE_AIR, 2.0), heights(84, 0.0002))
    assert seen.n_touchdowns == 3
    assert seen.landing_speeds_m_s == pytest.approx([0.1, 0.1])


@given(st.lists(st.sampled_from([0.0, 2.0, 10.0, 30.0]), min_size=2, max_size=150), st.data())
def test_a_cut_into_two_motions_changes_nothing(row: list[float], data: st.DataObject) -> None:
    cut = data.draw(st.integers(1, len(row) - 1))
    load, height = forces(*row), np.random.default_rng(len(row)).uniform(0.0, 0.1, (len(row), 4))
    whole = LoadWatch(ROBOT).take(load, height)
    watch = LoadWatch(ROBOT)
    parts = [watch.take(load[:cut], height[:cut]), watch.take(load[cut:], height[cut:])]
    np.testing.assert_array_equal(np.concatenate([part.loaded for part in parts]), whole.loaded)
    assert sum(part.n_touchdowns for part in parts) == whole.n_touchdowns
    assert sum(part.n_loadings for part in parts) == whole.n_loadings
    speeds = np.concatenate([part.landing_speeds_m_s for part in parts])
    np.testing.assert_array_equal(speeds, whole.landing_speeds_m_s)
