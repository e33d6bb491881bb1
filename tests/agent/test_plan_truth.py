"""What plan-check knows about clearance, against every square looked at."""

import numpy as np
import pytest

from agent_proc.plan_check.truth import clearance
from planner_proc.occupancy import ClearanceField
from tests.planner.maps import grid, random_room


@pytest.mark.parametrize("seed", range(12))
def test_clearance_is_that_of_the_planner_to_the_last_digit(seed: int) -> None:
    random = np.random.default_rng(seed)
    room = random_room(random)
    points = random.uniform([0.3, 0.3], [7.7, 5.7], (5, 2))
    points = points[ClearanceField(room).clearance_m(points) > 0.0]
    if len(points) < 2:
        points = np.array([[0.05, 0.05], [0.05, 0.06]])

    expected = ClearanceField(room).path_clearance_m(points)
    nearest = clearance(room, points)

    assert nearest.distance_m == pytest.approx(expected, abs=1e-9)


def test_a_point_alone_and_an_empty_map_have_a_clearance() -> None:
    empty = grid(np.zeros((10, 20), dtype=np.bool_))

    assert clearance(empty, np.array([[0.5, 0.4]])).distance_m == pytest.approx(0.4)
    assert clearance(empty, np.array([[0.5, 0.4], [1.9, 0.4]])).distance_m == pytest.approx(0.1)
    assert clearance(empty, np.array([[0.5, 0.4], [2.5, 0.4]])).distance_m == 0.0
