from pathlib import Path

import pytest

from legpush.errors import ConfigError
from legpush.study.file import load_study, read_study

from .parts import STUB, study_of


def test_cells_are_all_combinations_and_the_first_axis_varies_slowest() -> None:
    study = study_of('[axes]\nfactor = [1.0, 2.0]\nseed = { first = 0, n = 3 }\n[settings]\n"box.mass_kg" = 0.5\n')
    inputs = [task.inputs for task in study.tasks()]
    assert [(row["factor"], row["seed"]) for row in inputs] == [(1, 0), (1, 1), (1, 2), (2, 0), (2, 1), (2, 2)]
    assert {row["box.mass_kg"] for row in inputs} == {0.5}
    assert study.n_cells == 6


def test_the_identity_of_a_cell_depends_on_what_it_is_given_and_on_nothing_else() -> None:
    a, b = study_of("[axes]\nseed = [1, 2]\n"), study_of("[settings]\nfactor = 1\n[axes]\nseed = [2, 3]\n")
    assert a.task(1).cell == b.task(0).cell
    assert len({task.cell for study in (a, b) for task in study.tasks()}) == 3


def test_tables_among_the_inputs_are_columns_of_json() -> None:
    study = study_of("[settings]\nseed = 1\nroom.obstacles = [{ x_min_m = 1.0, x_max_m = 2.0 }]\n")
    assert study.task(0).inputs["room.obstacles"] == '[{"x_min_m":1.0,"x_max_m":2.0}]'


def test_a_study_without_axes_is_one_cell() -> None:
    assert [task.inputs["seed"] for task in study_of("[settings]\nseed = 4\n").tasks()] == [4]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("axis = 3", r"at `axis`: unknown field \(did you mean `axes`\?\)"),
        ("[settings]\nfactr = 3", "at settings: unknown field `factr`"),
        ('[axes]\nseed = ["a"]', "at `seed`: expected a whole number"),
        ("[axes]\nfactor = [1.0]", "at `seed`: expected a value, got nothing"),
        ("[axes]\nseed = { first = 0, n = 1_000_001 }", "expected at most 1000000 cells, got 1000001; --yes"),
        ('results = ["valu"]', "at `results`: expected columns among value, odd, .*, got valu"),
        ("results = []", "got an empty list"),
        ("[axes", "expected TOML"),
    ],
)
def test_a_wrong_file_is_refused_before_anything_runs(text: str, error: str) -> None:
    with pytest.raises(ConfigError, match=error):
        list(study_of(text).tasks())


def test_more_than_a_million_cells_are_accepted_when_asked_for_once_more() -> None:
    text = 'name = "many"\n[axes]\nseed = { first = 0, n = 2_000_000 }'
    assert read_study(text, "f", own_cell=STUB, many=True).task(1_999_999).inputs["seed"] == 1_999_999


@pytest.mark.parametrize(
    ("cell", "own", "error"),
    [
        (f'cell = "{STUB}"', None, f"which runs code: --cell {STUB} if you trust it"),
        ("", None, "expected one of .*mission.*, got no cell: --cell module:function"),
        ('cell = "misson"', None, "expected one of calibration, mission, plan, push, training, got 'misson'"),
        ('cell = "push"', STUB, "or none with --cell, got push"),
        ('cell = "os:getcwd"', STUB, "as --cell says, got os:getcwd"),
        ("", "push", "Expected module:function for --cell, got 'push'"),
        ("", "no.such:thing", "Expected module:function that can be imported"),
    ],
)
def test_code_is_named_by_the_command_line_only(cell: str, own: str | None, error: str) -> None:
    with pytest.raises(ConfigError, match=error):
        read_study(f'name = "own"\n{cell}', "f", own_cell=own)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none\.toml: expected a readable study file \(No such file or directory\)$"):
        load_study(tmp_path / "none.toml")
