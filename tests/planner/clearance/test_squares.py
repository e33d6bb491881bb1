"""Distances to unit squares, compared with many points of the segments."""

import numpy as np
import pytest

from planner_proc.clearance.squares import point_square_offsets, segment_distances


def test_an_offset_leads_from_the_nearest_point_of_a_square() -> None:
    points = np.array([[3.0, 0.5], [2.4, 0.7], [-1.0, -2.0]])
    squares = np.array([[1, 0], [2, 0], [0, 0]])

    np.testing.assert_allclose(point_square_offsets(points, squares), [[1.0, 0.0], [0.0, 0.0], [-1.0, -2.0]])


@pytest.mark.parametrize("seed", range(4))
def test_each_segment_has_the_distance_to_the_nearest_of_its_own_squares(seed: int) -> None:
    random = np.random.default_rng(seed)
    a, b = random.uniform(0.0, 12.0, (2, 20, 2))
    b[0] = a[0]
    n_squares = random.integers(1, 5, 20)
    columns, rows = random.integers(0, 12, (2, n_squares.sum()))

    distances = segment_distances(a, b, columns, rows, n_squares)

    owner = np.repeat(np.arange(20), n_squares)
    for k, (begin, end) in enumerate(zip(a, b, strict=True)):
        points = begin + np.linspace(0.0, 1.0, 2001)[:, None] * (end - begin)
        squares = np.stack([columns, rows], axis=1)[owner == k]
        sampled = min(np.hypot(*point_square_offsets(points, square[None]).T).min() for square in squares)
        spacing = np.hypot(*(end - begin)) / 2000
        assert sampled - spacing <= distances[k] <= sampled + 1e-9
    assert 0 < (distances == 0.0).sum() < 20


def test_a_segment_without_squares_is_infinitely_far_and_one_that_touches_a_corner_is_not_apart() -> None:
    a, b = np.array([[0.0, 2.0], [0.0, 2.0]]), np.array([[2.0, 0.0], [2.0, 0.0]])

    assert segment_distances(a, b, np.array([1]), np.array([1]), np.array([0, 1])).tolist() == [np.inf, 0.0]
    assert segment_distances(a, b, np.array([], dtype=int), np.array([], dtype=int), np.array([0, 0])).min() == np.inf
