"""Measures and samples of polylines."""

import numpy as np
import pytest

from legpush.scene.paths import distances_m
from planner_proc.smoothing import polylines

LINE = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]])


def test_distances_and_radii_of_a_circle() -> None:
    angles = np.linspace(0.0, 3.0, 50)
    circle = 2.0 * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    np.testing.assert_allclose(polylines.turning_radii(circle), 2.0)
    assert distances_m(np.array([[0.0, 0.0], [3.0, 0.0]]), circle) == pytest.approx([2.0, 1.0], abs=0.01)
    assert np.isinf(polylines.turning_radii(np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]))).all()


def test_points_are_found_by_the_length_up_to_them() -> None:
    assert polylines.length(LINE) == 7.0
    np.testing.assert_allclose(
        polylines.at(LINE, np.array([0.0, 3.0, 7.0]), np.array([1.5, 3.0, 5.0])), [[1.5, 0.0], [3.0, 0.0], [3.0, 2.0]]
    )


def test_a_subdivided_polyline_has_the_same_vertices_and_no_longer_segments() -> None:
    fine = polylines.subdivide(LINE, 0.9)

    assert np.hypot(*np.diff(fine, axis=0).T).max() <= 0.9
    assert len(fine) == 4 + 5 + 1
    assert polylines.length(fine) == pytest.approx(7.0)
    for vertex in LINE:
        assert np.isclose(fine, vertex).all(axis=1).any()


def test_headings_are_half_way_between_segments_and_turns_go_the_short_way_round() -> None:
    np.testing.assert_allclose(polylines.headings(LINE), [0.0, np.pi / 4, np.pi / 2])
    left_then_down = np.array([[0.0, 0.0], [-1.0, 0.1], [-2.0, 0.0]])
    np.testing.assert_allclose(polylines.turns(left_then_down), [2 * np.arctan(0.1)])
