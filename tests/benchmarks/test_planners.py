"""The measures of `benchmarks.planners`, and a few of its random requests."""

import numpy as np
import pytest

from benchmarks.planners.collisions import RandomRequest, judged
from benchmarks.planners.compare import COMPARED, Compared
from benchmarks.planners.measures import curvature_rms
from benchmarks.planners.random_requests import random_request
from legpush.study.cells import columns_of


def test_the_curvature_of_an_arc_is_one_over_its_radius_and_that_of_a_line_is_nothing() -> None:
    angles = np.linspace(0.0, 3.0, 400)
    arc = 2.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)

    assert curvature_rms(arc) == pytest.approx(0.5, rel=0.02)
    assert curvature_rms(np.array([[0.0, 0.0], [3.0, 1.0]])) == pytest.approx(0.0, abs=1e-6)


def test_driving_backward_is_no_turn_where_a_path_may() -> None:
    there_and_back = np.array([[0.0, 0.0], [1.0, 0.0], [0.4, 0.0]])

    assert curvature_rms(there_and_back) > 5.0
    assert curvature_rms(there_and_back, folded=True) == pytest.approx(0.0, abs=1e-6)


def test_a_random_request_depends_on_its_number_alone() -> None:
    assert random_request(17) == random_request(17)
    assert random_request(17) != random_request(18)


def test_a_few_random_requests_end_without_a_collision_or_another_fault() -> None:
    rows = [judged(RandomRequest(number=number)) for number in range(20_000, 20_024)]

    assert [row["faults"] for row in rows] == [""] * 24
    assert sum(row["n_paths"] for row in rows) > 12
    assert len({row["planner"] for row in rows}) == 6


def test_a_planner_gives_the_same_path_again_with_a_length_and_a_clearance() -> None:
    found, again = (columns_of(COMPARED, Compared(seed=3, map="around a wall", planner="rrt_connect")) for _ in "ab")

    assert found["status"] == "exact"
    assert found["keeps_clearance"] is True
    assert 10.0 < found["length_m"] <= found["first_length_m"] + 1e-6
    free = {column.name for column in COMPARED.columns if column.may_differ}
    assert {name: found[name] for name in found.keys() - free} == {name: again[name] for name in again.keys() - free}


def test_a_planner_that_finds_nothing_has_no_measures() -> None:
    found = columns_of(COMPARED, Compared(seed=0, map="maze", planner="rrt_star", steering="dubins"))

    assert found["status"] != "exact"
    assert (found["first_s"], found["length_m"], found["keeps_clearance"]) == (None, None, None)
