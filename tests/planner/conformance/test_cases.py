"""The cases are what their names say, and the built-in planner answers them honestly."""

import numpy as np
import pytest

from planner_proc.conformance.cases import AHEAD, RESOLUTION_M, Case, box_query, cases, huge, room
from planner_proc.planning import make_plan


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_the_built_in_planner_gives_an_honest_answer_to_each_case(case: Case) -> None:
    assert make_plan(case.query).status in case.expected


def test_no_two_cases_bear_the_same_name() -> None:
    names = [case.name for case in cases()]

    assert len(set(names)) == len(names) > 5


def test_a_block_of_a_room_covers_its_cells() -> None:
    grid = room(2.0, 1.0, (0.5, 1.0, 0.2, 0.4))
    cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)

    assert (grid.n_columns, grid.n_rows, grid.resolution_m) == (40, 20, RESOLUTION_M)
    assert cells.sum() == 10 * 4
    assert cells[4:8, 10:20].all()


def test_the_huge_map_has_16_million_cells_and_a_box_query_a_side_to_push() -> None:
    assert len(huge().grid.cells) == 4000**2
    asked = box_query(AHEAD)
    assert asked.goal == AHEAD
    assert len(asked.sides) == 1
