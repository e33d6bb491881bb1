import pytest
from msgspec.structs import replace

from legpush.canary import Canary
from legpush.study import work as module
from legpush.study.identity import code_version
from legpush.study.jobs import Answer, Job, decode_answer, encode
from legpush.study.work import work

from .parts import STUB, study_of


def done(job: Job) -> Answer:
    return decode_answer(work(encode(job)))


def job_of(text: str, *, canary: str | None = None, results: tuple[str, ...] | None = None) -> Job:
    study = study_of(text)
    return Job(kind=STUB, code=study.code, canary=canary, results=results, tasks=tuple(study.tasks()))


def test_a_row_has_inputs_results_and_where_they_come_from() -> None:
    answer = done(job_of("[settings]\nfactor = 3.0\n[axes]\nseed = [4]\n"))
    columns = answer.rows[0].columns
    assert (columns["seed"], columns["factor"], columns["value"], columns["track"]) == (4, 3.0, 12.0, [4, 5])
    assert (columns["code"], columns["host"]) == (study_of().code, answer.host)
    assert columns["wall_s"] >= 0.0 <= columns["cpu_s"]
    assert columns["state_crc"] == f"{4 * 2654435761 % 2**32:08x}"


def test_only_the_columns_that_were_asked_for_are_kept_and_the_crc() -> None:
    columns = done(job_of("[axes]\nseed = [4]\n", results=("odd",))).rows[0].columns
    assert "odd" in columns
    assert "state_crc" in columns
    assert "value" not in columns


def test_a_cell_that_raises_leaves_its_last_words_and_the_others_run() -> None:
    answer = done(job_of("[settings]\nfail_every = 2\n[axes]\nseed = [1, 2, 3]\n"))
    assert [row.columns["seed"] for row in answer.rows] == [1, 3]
    (failure,) = answer.failures
    assert failure.error == "ValueError: seed 2 is a multiple of 2"
    assert "stub.py" in failure.traceback


def test_a_result_with_the_name_of_an_input_fails() -> None:
    task = study_of("[axes]\nseed = [1]\n").task(0)
    clash = replace(task, inputs={**task.inputs, "value": 1})
    answer = done(Job(kind=STUB, code=study_of().code, canary=None, results=None, tasks=(clash,)))
    assert "got value twice" in answer.failures[0].error


def test_another_code_version_is_refused_and_runs_nothing() -> None:
    answer = done(replace(job_of("[axes]\nseed = [1]\n"), code="0123"))
    assert answer.refused is not None
    assert answer.refused.startswith("expected the code version 0123, has ")
    assert answer.rows == ()


def test_another_canary_is_refused() -> None:
    answer = done(job_of("[axes]\nseed = [1]\n", canary="00000000"))
    assert answer.refused is not None
    assert answer.refused.startswith("expected the canary 00000000")
    assert answer.rows == ()


def test_a_worker_that_computes_other_bits_than_were_published_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_canary", lambda: "11111111")
    monkeypatch.setattr(module, "published", lambda _: Canary(plan="a", walk="b", turn="b", push="c", learned="c"))
    job = replace(job_of("[axes]\nseed = [1]\n"), kind="plan", tasks=())
    answer = done(replace(job, code=code_version("plan")))
    assert answer.refused is not None
    assert answer.refused.startswith("expected the published canary ")
