"""Obstacles of a room as the cells of a map."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from legpush.scenarios.grid import merged_rectangles
from legpush.scene.scenario import Rectangle


@given(data=st.data(), n_rows=st.integers(1, 12), n_columns=st.integers(1, 12))
def test_merged_rectangles_cover_exactly_the_occupied_cells_once(
    data: st.DataObject, n_rows: int, n_columns: int
) -> None:
    bits = data.draw(st.lists(st.booleans(), min_size=n_rows * n_columns, max_size=n_rows * n_columns))
    occupied = np.array(bits).reshape(n_rows, n_columns)
    covered = np.zeros_like(occupied, dtype=int)
    for r in merged_rectangles(occupied, 0.5):
        covered[round(r.y_min_m * 2) : round(r.y_max_m * 2), round(r.x_min_m * 2) : round(r.x_max_m * 2)] += 1
    assert (covered == occupied).all()


def test_a_solid_block_of_cells_is_one_rectangle() -> None:
    assert merged_rectangles(np.ones((3, 4), dtype=bool), 2.0) == (
        Rectangle(x_min_m=0.0, x_max_m=8.0, y_min_m=0.0, y_max_m=6.0),
    )
