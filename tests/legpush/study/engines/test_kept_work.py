"""Work whose rows the worker keeps."""

from pathlib import Path
from typing import Any

import pytest

from legpush.study.engines import kept_work
from legpush.study.engines.kept_work import work_and_keep
from legpush.study.identity import code_version
from legpush.study.jobs import Answer, Job, Task, decode_answer, encode
from legpush.study.rows import read_rows

KIND = "tests.legpush.study.stub:STUB"


def job(seeds: range, *, code: str | None = None, **settings: Any) -> bytes:
    """A job with a cell for each seed."""
    tasks = tuple(
        Task(cell=f"{seed:032x}", inputs={"seed": seed}, specification={"seed": seed, **settings}) for seed in seeds
    )
    return encode(Job(kind=KIND, code=code or code_version(KIND), canary=None, results=None, tasks=tasks))


def run(parts: Path, payload: bytes, *, again: bool = False) -> Answer:
    return decode_answer(work_and_keep(parts, payload, again=again))


def kept(parts: Path) -> list[int]:
    table = read_rows(sorted(parts.iterdir()))
    return [] if table is None else sorted(table.column("seed").to_pylist())


def test_rows_lie_in_the_folder_and_in_the_answer(tmp_path: Path) -> None:
    answer = run(tmp_path, job(range(5)))
    assert sorted(row.columns["seed"] for row in answer.rows) == [0, 1, 2, 3, 4] == kept(tmp_path)
    assert len(list(tmp_path.iterdir())) == 1


def test_rows_are_written_while_the_job_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_work, "FLUSH_S", 0.0)
    run(tmp_path, job(range(3)))
    assert len(list(tmp_path.iterdir())) == 3


def test_a_job_that_is_started_again_leaves_out_what_it_has_and_answers_with_all(tmp_path: Path) -> None:
    run(tmp_path, job(range(3)))
    first = {path.name for path in tmp_path.iterdir()}

    answer = run(tmp_path, job(range(5)), again=True)

    assert sorted(row.columns["seed"] for row in answer.rows) == [0, 1, 2, 3, 4] == kept(tmp_path)
    (second,) = (path for path in tmp_path.iterdir() if path.name not in first)
    assert kept_seeds(second) == [3, 4]


def kept_seeds(part: Path) -> list[int]:
    table = read_rows([part])
    assert table is not None
    seeds: list[int] = sorted(table.column("seed").to_pylist())
    return seeds


def test_a_cell_that_fails_is_told_and_the_others_go_on(tmp_path: Path) -> None:
    answer = run(tmp_path, job(range(1, 5), fail_every=2))
    assert [int(failure.cell, 16) for failure in answer.failures] == [2, 4]
    assert kept(tmp_path) == [1, 3]


def test_a_refused_job_runs_no_cell(tmp_path: Path) -> None:
    answer = run(tmp_path, job(range(5), code="another"))
    assert answer.refused is not None
    assert not answer.rows
    assert list(tmp_path.iterdir()) == []


def test_a_job_without_cells_says_what_the_worker_is(tmp_path: Path) -> None:
    answer = run(tmp_path, job(range(0)))
    assert answer.refused is None
    assert not answer.rows
