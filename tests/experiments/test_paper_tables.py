"""Tables of what the paper states find what is known in made-up series and rows."""

from typing import Any

import numpy as np
import pytest

from experiments.tables.paper.mass_trend import slope
from experiments.tables.paper.push_curves import curve_name
from experiments.tables.paper.turn_rate import cycle_time_s


def test_the_time_of_a_push_cycle_is_found_in_a_box_that_moves_and_stands_by_turns() -> None:
    time_s = np.arange(0.0, 30_000.0, 22.5)
    pushes = np.floor(time_s / 93.0)
    series = np.column_stack([time_s, np.sin(2 * np.pi * pushes / 160)])

    found = cycle_time_s(series)

    assert found.value == pytest.approx(93.0, abs=1.5)
    assert found.n >= 9


def test_the_slope_of_a_line_is_found_with_its_interval() -> None:
    found = slope([0.1, 0.3, 0.5, 0.7], [1.0, 1.2, 1.4, 1.6])

    assert (found.value, found.low, found.high) == pytest.approx((1.0, 1.0, 1.0))
    assert found.n == 4


@pytest.mark.parametrize(
    ("weights", "name"), [([], "chord"), ([0.5], "all 0.5"), ([0.25, 0.25], "all 0.25"), ([0.2, 0.4, 0.6], "even")]
)
def test_a_curve_is_named_by_its_inner_control_points(weights: list[float], name: str) -> None:
    row: dict[str, Any] = {"weights": weights}

    assert curve_name(row) == name
