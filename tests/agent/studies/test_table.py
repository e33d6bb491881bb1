from pathlib import Path
from typing import Any

import pytest

from agent_proc.statistics.intervals import mean, share
from agent_proc.studies.table import (
    Pairing,
    StudyRows,
    as_csv,
    groups_of,
    make_table,
    measures_of,
    pairing_of,
    read_study_rows,
)
from legpush.errors import ConfigError
from legpush.study.folder import StudyFolder, StudyRecord

RECORD = StudyRecord(
    name="try",
    kind="push",
    n_cells=8,
    cells_sha256="",
    code="",
    inputs=("seed", "policy", "box.mass_kg", "scenario"),
    axes=("policy", "box.mass_kg", "seed"),
    may_differ=(),
    units={"error_m": "m", "speed": "m/s"},
    canary=None,
    versions={},
    command="",
)


def row(policy: str, mass_kg: float, seed: int, error_m: float | None, success: bool) -> dict[str, Any]:
    return {
        "cell": f"{policy}{mass_kg}{seed}",
        "seed": seed,
        "policy": policy,
        "box.mass_kg": mass_kg,
        "scenario": "push",
        "error_m": error_m,
        "success": success,
        "reason": "done",
        "track": [1.0, 2.0],
        "host": "a",
        "cpu_s": 1.0,
    }


ROWS = [
    row("a", 0.1, 0, 1.0, True),
    row("a", 0.1, 1, 2.0, False),
    row("a", 0.5, 0, 3.0, True),
    row("a", 0.5, 1, float("inf"), True),
    row("b", 0.1, 0, 1.5, True),
    row("b", 0.1, 1, 2.5, True),
    row("b", 0.5, 0, 5.0, True),
    row("b", 0.5, 1, 5.0, False),
]
STUDY = StudyRows(record=RECORD, inputs=RECORD.inputs, rows=ROWS)


def test_groups_are_the_axes_but_the_seed_and_measures_the_numbers_among_the_results() -> None:
    assert groups_of(STUDY, ()) == ("policy", "box.mass_kg")
    assert groups_of(STUDY, ("box.mass_kg",), Pairing(axis="policy", value="a")) == ("box.mass_kg", "policy")
    assert groups_of(STUDY, (), Pairing(axis="policy", value="a")) == ("box.mass_kg", "policy")
    assert measures_of(STUDY, ()) == ("error_m", "success")
    assert measures_of(STUDY, ("cpu_s",)) == ("cpu_s",)


def test_means_and_shares_have_their_intervals_and_cells_without_a_value_do_not_count() -> None:
    lines = make_table(STUDY, ("policy",), ("error_m", "success"))
    assert [(line.measure, line.group["policy"], line.estimate.n) for line in lines] == [
        ("error_m", "a", 3),
        ("error_m", "b", 4),
        ("success", "a", 4),
        ("success", "b", 4),
    ]
    assert lines[0].estimate == mean([1.0, 2.0, 3.0])
    assert lines[2].estimate == share(3, 4)
    assert [line.how for line in lines[1:3]] == ["mean, Student's t 95 %", "share, Wilson 95 %"]


def test_without_groups_there_is_one_line() -> None:
    (line,) = make_table(STUDY, (), ("success",))
    assert (line.estimate.n, line.estimate) == (8, share(6, 8))


def test_differences_are_taken_between_cells_that_share_all_other_axes() -> None:
    lines = make_table(STUDY, ("box.mass_kg", "policy"), ("error_m", "success"), Pairing(axis="policy", value="a"))
    assert [(line.measure, line.group["box.mass_kg"], line.group["policy"], line.estimate.n) for line in lines] == [
        ("error_m", 0.1, "b", 2),
        ("error_m", 0.5, "b", 1),
        ("success", 0.1, "b", 2),
        ("success", 0.5, "b", 2),
    ]
    assert [line.estimate.value for line in lines] == [0.5, 2.0, 0.5, -0.5]
    assert [line.how for line in lines[:2]] == [
        "paired, all values equal of differences",
        "paired, no interval: n 1",
    ]


def test_a_pairing_is_read_from_text() -> None:
    assert pairing_of(STUDY, "policy=b") == Pairing(axis="policy", value="b")
    assert pairing_of(STUDY, "box.mass_kg=0.50") == Pairing(axis="box.mass_kg", value=0.5)


@pytest.mark.parametrize(
    ("call", "error"),
    [
        (lambda: groups_of(STUDY, ("polcy",)), r"for --by, got polcy \(did you mean `policy`\?\)"),
        (
            lambda: measures_of(STUDY, ("reason",)),
            "among error_m, success, cpu_s, wall_s for --measure",
        ),
        (lambda: pairing_of(STUDY, "scenario=push"), "Expected a column among policy, box.mass_kg, seed for --paired"),
        (lambda: pairing_of(STUDY, "policy=c"), "Expected a value of policy among a, b for --paired, got c"),
    ],
)
def test_unknown_columns_and_values_are_refused_with_the_valid_ones(call: Any, error: str) -> None:
    with pytest.raises(ConfigError, match=error):
        call()


def test_a_title_has_the_unit_once() -> None:
    lines = make_table(
        StudyRows(record=RECORD, inputs=(), rows=[{"error_m": 1.0, "speed": 2.0}]), (), ("error_m", "speed")
    )
    assert [line.title for line in lines] == ["error_m", "speed [m/s]"]


def test_csv_has_a_line_per_number() -> None:
    text = as_csv(make_table(STUDY, ("policy",), ("error_m",)), ("policy",))
    assert text.splitlines()[0] == "measure,unit,policy,n,value,low,high,how"
    assert text.splitlines()[1].startswith("error_m,m,a,3,2.0,")


def test_a_folder_without_rows_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="expected the folder of a study"):
        read_study_rows(StudyFolder(tmp_path))
