"""Shortcuts through jagged paths."""

import numpy as np

from legpush.scene.paths import distances_m
from planner_proc.clearance.field import ClearanceField
from planner_proc.smoothing import polylines
from planner_proc.smoothing.shortcut import shortcut
from planner_proc.smoothing.tube import Tube
from tests.planner import maps


def test_a_shortcut_is_free_and_no_longer_and_taut_in_the_open() -> None:
    grid = maps.room((3.0, 4.0, 0.0, 4.0))
    field = ClearanceField(grid)
    jagged = np.array([[1.0, 1.0], [0.6, 3.0], [2.0, 3.2], [1.8, 5.4], [4.5, 4.8], [6.0, 5.4], [5.0, 3.0], [7.0, 1.0]])
    assert field.free_segments(jagged, 0.44).all()
    path = shortcut(jagged, Tube(field, 0.44, jagged))
    assert maps.true_clearance(grid, maps.samples(path, 0.005)).min() >= 0.44 - 1e-8
    shortest = 2 * np.hypot(1.56, 3.0) + np.hypot(0.0, 1.0)
    assert shortest < polylines.length(path) < 0.75 * polylines.length(jagged)
    np.testing.assert_array_equal(path[[0, -1]], jagged[[0, -1]])
    detour = np.array([[0.6, 5.0], [1.0, 5.4], [2.0, 4.6], [2.4, 5.0]])
    np.testing.assert_array_equal(shortcut(detour, Tube(field, 0.44, detour)), detour[[0, -1]])


def test_a_shortcut_stays_as_near_to_the_path_as_was_asked_for() -> None:
    jagged = np.array([[1.0, 1.0], [2.0, 2.0], [3.0, 1.0], [4.0, 2.0], [5.0, 1.0]])
    wide, narrow = (
        shortcut(jagged, Tube(ClearanceField(maps.room()), 0.44, jagged, deviation_m)) for deviation_m in (None, 0.3)
    )

    assert polylines.length(wide) == 4.0
    assert distances_m(maps.samples(narrow, 0.01), jagged).max() <= 0.3 + 1e-6
    assert 4.0 < polylines.length(narrow) < polylines.length(jagged)
