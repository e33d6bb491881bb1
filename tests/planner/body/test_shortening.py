"""Shortened motions of the body keep their ends and their clearance, and cost no more."""

import numpy as np
import pytest

from planner_proc.body.motion import cost_m
from planner_proc.body.shortening import shortened
from planner_proc.body.space import BodySpace
from planner_proc.clearance.field import ClearanceField
from tests.planner.bodies import BODY, BODY_M
from tests.planner.maps import room

BLOCK = room((2.0, 3.5, 0.0, 3.0))


def space() -> BodySpace:
    return BodySpace(BLOCK, ClearanceField(BLOCK), 0.3, BODY, BODY_M)


def test_a_staircase_in_the_open_becomes_a_line() -> None:
    steps = np.repeat(np.arange(11) * 0.1, 2)
    stairs = np.column_stack([4.5 + steps[1:], 4.0 + steps[:-1], np.zeros(21)])

    short = shortened(stairs, space())

    np.testing.assert_allclose(short[[0, -1]], stairs[[0, -1]])
    assert len(short) < 5
    assert cost_m(short, 0.6) < cost_m(stairs, 0.6)


def test_a_way_around_a_block_still_leads_around_it() -> None:
    around = np.array([[1.0, 1.0, np.pi / 2], [1.0, 4.0, np.pi / 2], [1.0, 4.0, 0.0], [4.5, 4.0, 0.0], [4.5, 1.0, 0.0]])

    short = shortened(around, space())

    assert space().is_free(short)
    assert short[:, 1].max() > 3.2
    assert cost_m(short, space().reach_m) <= cost_m(around, space().reach_m) + 1e-9


@pytest.mark.parametrize("n", [1, 2])
def test_nothing_is_left_out_of_the_shortest_motions(n: int) -> None:
    poses = np.array([[5.0, 4.0, 0.0], [5.5, 4.0, 0.0]])[:n]

    np.testing.assert_allclose(shortened(poses, space()), poses)
