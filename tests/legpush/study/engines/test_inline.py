"""The engine without workers."""

import os

import pytest
from msgspec.structs import replace

from legpush.errors import LegpushError
from legpush.study.engines.inline import InlineEngine
from legpush.study.jobs import Job, decode_answer, encode
from tests.legpush.study.parts import STUB, study_of


def job() -> Job:
    study = study_of("[axes]\nseed = [4, 5]\n")
    return Job(kind=STUB, code=study.code, canary=None, results=None, tasks=tuple(study.tasks()))


def test_cells_run_in_this_process() -> None:
    engine = InlineEngine()
    answer = decode_answer(engine.submit(encode(job())).result(0.0))
    assert answer.pid == os.getpid()
    assert [row.columns["seed"] for row in answer.rows] == [4, 5]
    assert engine.n_slots() == 1


def test_a_job_that_cannot_be_run_is_an_error_of_its_own() -> None:
    future = InlineEngine().submit(encode(replace(job(), kind="nothing")))
    with pytest.raises(LegpushError, match="nothing"):
        future.result(0.0)
