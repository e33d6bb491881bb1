"""Polylines with their corners rounded by arcs."""

import numpy as np
import pytest

from legpush.scene.paths import distances_m
from planner_proc.smoothing import polylines
from planner_proc.smoothing.fillets import fillet

CORNER = np.array([[1.0, 1.0], [4.0, 1.0], [4.0, 5.0], [7.0, 5.0]])


def test_arcs_at_corners_join_lines_without_a_kink() -> None:
    path = fillet(CORNER, 0.7, 0.05)
    assert path is not None
    assert polylines.turning_radii(path).min() >= 0.99 * 0.7
    assert distances_m(path, CORNER).max() == pytest.approx(0.7 * (1.0 - np.sqrt(0.5)), abs=0.01)
    assert fillet(CORNER, 2.1, 0.05) is None
    assert fillet(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]), 0.1, 0.05) is None


def test_the_points_begin_and_end_with_the_polyline_and_are_no_farther_apart_than_the_spacing() -> None:
    path = fillet(CORNER, 0.7, 0.05)
    assert path is not None
    np.testing.assert_array_equal(path[[0, -1]], CORNER[[0, -1]])
    assert np.hypot(*np.diff(path, axis=0).T).max() <= 0.05 + 1e-9
    assert polylines.length(path) == pytest.approx(10.0 - 4 * 0.7 + np.pi * 0.7, abs=0.01)
