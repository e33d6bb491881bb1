"""Rows of studies say how they were made; only complete studies are kept."""

import re
import subprocess
from pathlib import Path
from typing import Any

import pyarrow
import pytest

from experiments import keep
from experiments.rows import ROWS, Made, in_runs, read_rows, write_rows
from legpush.errors import ConfigError
from legpush.study.folder import StudyFolder

MADE = Made(version="0.1.0", commit="abcdef0", command="legpush study run x.toml", note="by hand")


def test_rows_are_read_as_they_were_written(tmp_path: Path) -> None:
    write_rows(pyarrow.table({"seed": [1, 2], "x_m": [0.5, None]}), "walks", MADE, tmp_path)

    found = read_rows("walks", tmp_path)

    assert found.made == MADE
    assert found.rows == [{"seed": 1, "x_m": 0.5}, {"seed": 2, "x_m": None}]
    assert found.where(seed=2) == [{"seed": 2, "x_m": None}]


def test_missing_rows_are_an_error_that_names_the_command(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"walks\.parquet: expected the rows of a study, as `python -m experiments"):
        read_rows("walks", tmp_path)


@pytest.mark.parametrize("path", sorted(ROWS.glob("*.parquet")), ids=lambda path: path.stem)
def test_kept_rows_have_version_commit_and_command_and_no_names_of_hosts(path: Path) -> None:
    found = read_rows(path.stem)

    assert found.rows
    assert all((found.made.version, found.made.commit, found.made.command))
    assert "host" not in found.rows[0]
    assert found.made.note or found.made.code


def study(folder: Path, **changes: Any) -> StudyFolder:
    """The folder of a study of two cells, which are both done."""
    from legpush.study.folder import StudyRecord
    from legpush.study.rows import write_table

    record = StudyRecord(
        name="walks",
        kind="walk",
        n_cells=2,
        cells_sha256="",
        code="c0de",
        inputs=("seed",),
        axes=("seed",),
        may_differ=(),
        units={},
        canary=None,
        versions={"legpush": "0.1.0"},
        command="legpush study run walks.toml",
    )
    found = StudyFolder(folder)
    with found.opened(("",), record):
        pass
    columns = {"cell": ["a", "b"], "seed": [1, 2], "host": ["h", "h"], "policy_zip": ["", ""], **changes}
    write_table(pyarrow.table(columns), found.table)
    return found


def test_a_complete_study_is_kept_without_policies_and_hosts(tmp_path: Path) -> None:
    path = keep.keep(study(tmp_path / "study"), tmp_path / "rows")

    found = read_rows("walks", tmp_path / "rows")
    assert path == tmp_path / "rows" / "walks.parquet"
    assert found.rows == [{"cell": "a", "seed": 1}, {"cell": "b", "seed": 2}]
    assert (found.made.version, found.made.code, found.made.command) == (
        "0.1.0",
        "c0de",
        "legpush study run walks.toml",
    )
    assert found.made.commit.strip("+") == keep.commit().strip("+")


def test_a_commit_with_changes_is_marked_unless_results_alone_changed(tmp_path: Path) -> None:
    names = ("code.py", "experiments/results/a.json", "benchmarks/results/b.json")
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("1")
    who = ("-c", "user.name=A", "-c", "user.email=a@example.org")
    for words in (("init", "-q"), ("add", "-A"), (*who, "commit", "-q", "-m", "first")):
        subprocess.run(["git", *words], cwd=tmp_path, check=True)
    clean = keep.commit(tmp_path)
    assert re.fullmatch("[0-9a-f]{7}", clean)

    for name in names[1:]:
        (tmp_path / name).write_text("2")
    assert keep.commit(tmp_path) == clean
    (tmp_path / "code.py").write_text("2")
    assert keep.commit(tmp_path) == f"{clean}+"


def test_an_incomplete_study_is_not_kept(tmp_path: Path) -> None:
    short = study(tmp_path / "study", cell=["a"], seed=[1], host=["h"], policy_zip=[""])

    with pytest.raises(ConfigError, match="expected a study with all 2 rows in one table, got 1"):
        keep.keep(short, tmp_path / "rows")


def test_a_command_names_the_folder_of_the_page_and_none_of_a_machine() -> None:
    command = "legpush study run experiments/studies/walking.toml --out /home/me/w2 --workers 1"

    assert (
        in_runs(command, "walking")
        == "legpush study run experiments/studies/walking.toml --out runs/walking --workers 1"
    )
