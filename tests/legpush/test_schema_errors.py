"""Errors of a schema, as the author of a file reads them."""

from collections.abc import Callable
from pathlib import Path

import pytest

from legpush.errors import ScenarioError
from legpush.scenarios.file import load_scenario
from tests.legpush.scenarios.small_scenario import Plain, drop, plain_scenario, put, write

SCHEMA_ERRORS: dict[str, tuple[Callable[[Plain], None], str]] = {
    "unknown field": (
        put("box", "mas_kg", value=1.0),
        r"at `box\.mas_kg`: unknown field \(did you mean `mass_kg`\?\); valid here: pose, size_m, shape, mass_kg, fric",
    ),
    "unknown table": (
        put("planing", "planner", value="rrt"),
        r"at `planing`: unknown field \(did you mean `planning`\?\)",
    ),
    "field of the room that is neither its own nor a grid's": (
        put("room", "grid", value="a.csv"),
        r"at `room\.grid`: unknown field .*valid here: size_m, .*, grid_file, cell_m, first_row",
    ),
    "missing field": (drop("start", "x_m"), r"at `start\.x_m`: expected a value, got nothing"),
    "negative mass": (
        put("box", "mass_kg", value=-1.0),
        r"at `box\.mass_kg`: .* from 0\.001 to 1000, got -1\.0",
    ),
    "mistyped number": (put("start", "y_m", value="1"), r"at `start\.y_m`: expected a number, got a text '1'"),
    "truth value for a number": (
        put("box", "friction", value=True),
        r"at `box\.friction`: expected a number, got a truth",
    ),
    "number for a table": (put("goal", value=3), r"at `goal`: expected a table, got a whole number 3"),
    "unknown planner": (
        put("planning", "planner", value="prm"),
        r"at `planning\.planner`: expected one of bit_star, informed_rrt_star, prm_star, rrt, .*, got 'prm'",
    ),
    "not a number": (put("start", "x_m", value=float("nan")), r"at `start\.x_m`: expected a finite number, got nan"),
    "infinite": (
        put("goal", "pose", "x_m", value=float("inf")),
        r"at `goal\.pose\.x_m`: expected a finite number, got inf",
    ),
    "infinite mass": (
        put("box", "mass_kg", value=float("inf")),
        r"at `box\.mass_kg`: expected a finite number, got inf",
    ),
    "too few numbers": (put("room", "size_m", value=[8.0]), r"at `room\.size_m`: expected an array of length 2, got 1"),
    "no area": (
        put("room", "obstacles", 0, "x_max_m", value=2.0),
        r"at `room\.obstacles\[0\]`: expected x_min_m < x_max_m, by at least .* got 3\.0 and 2\.0",
    ),
    "time before the reset": (
        put("room", "obstacles", 0, "appears_at_s", value=-0.5),
        r"at `room\.obstacles\[0\]\.appears_at_s`: expected a number from 0 to 1e\+06, got -0\.5",
    ),
    "mistyped time": (
        put("room", "obstacles", 0, "apears_at_s", value=1.0),
        r"at `room\.obstacles\[0\]\.apears_at_s`: unknown field \(did you mean `appears_at_s`\?\)",
    ),
    "name with a slash": (put("name", value="a/b"), r"at `name`: expected a text matching regex .*, got 'a/b'"),
    "no budget": (
        put("planning", "max_iterations", value=0),
        r"at `planning\.max_iterations`: .* from 1 to 10000000, got 0",
    ),
}


@pytest.mark.parametrize(("edit", "words"), SCHEMA_ERRORS.values(), ids=SCHEMA_ERRORS)
def test_a_schema_error_names_file_field_expectation_and_value(
    edit: Callable[[Plain], None], words: str, tmp_path: Path
) -> None:
    plain = plain_scenario()
    edit(plain)
    with pytest.raises(ScenarioError, match=r"small\.toml:\d+: " + words):
        load_scenario(write(tmp_path, plain))
