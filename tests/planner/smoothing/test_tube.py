"""The region in which a smoothed path has to stay."""

import numpy as np
import pytest

from planner_proc.clearance.field import ClearanceField
from planner_proc.smoothing.tube import Tube
from tests.planner import maps

PATH = np.array([[1.0, 1.0], [4.0, 1.0], [4.0, 4.0]])
FIELD = ClearanceField(maps.room((5.0, 8.0, 0.0, 6.0)))


def test_without_a_greatest_deviation_only_the_clearance_counts() -> None:
    tube = Tube(FIELD, 0.44, PATH)
    points = np.array([[1.0, 5.0], [4.5, 5.0], [4.7, 5.0]])

    assert tube.free_segments(points).tolist() == [True, False]
    assert tube.segment_is_free((1.0, 5.0), (4.5, 5.0))
    assert not tube.segment_is_free((4.5, 5.0), (4.7, 5.0))


@pytest.mark.parametrize(
    ("a", "b", "is_free"),
    [
        ((1.0, 1.29), (3.0, 1.29), True),
        ((1.0, 1.31), (3.0, 1.31), False),
        ((2.5, 1.0), (4.0, 2.5), False),
        ((3.7, 1.0), (4.0, 1.3), True),
        ((1.0, 1.0), (4.0, 4.0), False),
    ],
)
def test_a_segment_is_free_only_if_all_of_it_is_near_the_path(
    a: tuple[float, float], b: tuple[float, float], is_free: bool
) -> None:
    tube = Tube(FIELD, 0.44, PATH, 0.3)

    assert tube.segment_is_free(a, b) is is_free
    assert tube.free_segments(np.array([a, b])).tolist() == [is_free]


def test_near_the_path_the_clearance_counts_too() -> None:
    tube = Tube(FIELD, 1.1, PATH, 0.3)

    assert not tube.segment_is_free((4.0, 1.0), (4.0, 3.0))
    assert Tube(FIELD, 0.9, PATH, 0.3).segment_is_free((4.0, 1.0), (4.0, 3.0))
