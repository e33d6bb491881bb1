import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.errors import LegpushError
from legpush.study.folder import StudyFolder
from legpush.study.jobs import Answer, Job, decode_answer, encode
from legpush.study.runner import EngineError, Runner, Tally
from legpush.study.work import work

from .parts import FakeEngine, begun, study_of


class Head:
    """A runner with everything that it needs."""

    def __init__(self, path: Path, text: str, answer: Callable[[Job], Answer | None] | None = None) -> None:
        self.study = study_of(text)
        self.folder: StudyFolder = begun(path, self.study)
        self.engine = FakeEngine(answer)
        self.tally = Tally(n_cells=self.study.n_cells, n_done=0)
        self.stop = threading.Event()
        self.canaries: list[str] = []

    def run(self, canary: str | None = None) -> None:
        job = Job(kind=self.study.kind_name, code=self.study.code, canary=canary, results=None, tasks=())
        Runner(
            self.engine,
            self.folder,
            job=job,
            task=self.study.task,
            missing=range(self.study.n_cells),
            tally=self.tally,
            stop=self.stop,
            on_canary=self.canaries.append,
        ).run()


def answered(job: Job) -> Answer:
    return decode_answer(work(encode(job)))


def seeds(job: Job) -> list[int]:
    return [task.specification["seed"] for task in job.tasks]


def test_every_cell_has_one_row_and_quick_cells_are_sent_in_batches(tmp_path: Path) -> None:
    head = Head(tmp_path, "[axes]\nseed = { first = 0, n = 500 }\n")
    head.run()
    table = head.folder.rows()
    assert table is not None
    assert sorted(table.column("seed").to_pylist()) == list(range(500))
    assert (head.tally.n_done, head.tally.n_failed, head.engine.closed_now) == (500, 0, False)
    assert len(head.engine.jobs) < 60
    assert max(len(job.tasks) for job in head.engine.jobs) > 50


def test_slow_cells_are_sent_one_by_one(tmp_path: Path) -> None:
    def slow(job: Job) -> Answer:
        answer = answered(job)
        return replace(answer, rows=tuple(replace(row, wall_s=4.0) for row in answer.rows))

    head = Head(tmp_path, "[axes]\nseed = { first = 0, n = 8 }\n", slow)
    head.run()
    assert [len(job.tasks) for job in head.engine.jobs] == [1] * 8


def test_a_cell_that_fails_by_itself_is_kept_and_not_tried_again(tmp_path: Path) -> None:
    head = Head(tmp_path, "[settings]\nfail_every = 3\n[axes]\nseed = { first = 0, n = 6 }\n")
    head.run()
    failures = sorted(head.folder.failures(), key=lambda failure: failure.inputs["seed"])
    assert [(failure.inputs["seed"], failure.own) for failure in failures] == [(0, True), (3, True)]
    assert (head.tally.n_done, head.tally.n_failed, head.tally.n_retried) == (4, 2, 0)


def test_the_cells_of_a_lost_worker_are_sent_again_and_the_last_time_alone(tmp_path: Path) -> None:
    head = Head(
        tmp_path, "[axes]\nseed = { first = 0, n = 40 }\n", lambda job: None if 7 in seeds(job) else answered(job)
    )
    head.run()
    (failure,) = head.folder.failures()
    assert (failure.inputs["seed"], failure.own) == (7, False)
    assert failure.error == "Worker 1 on this machine ended with SIGKILL, 3 times"
    assert head.tally.n_done == 39
    with_seven = [job for job in head.engine.jobs if 7 in seeds(job)]
    assert len(with_seven) == 3
    assert seeds(with_seven[-1]) == [7]


def test_a_worker_that_refuses_is_named_and_its_cells_run_elsewhere(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    refused: list[Job] = []

    def one_refuses(job: Job) -> Answer:
        if len(refused) < 2:
            refused.append(job)
            return Answer(host="old-node", pid=1, numerics="native", canary="bad", refused="expected the canary good")
        return answered(job)

    head = Head(tmp_path, "[axes]\nseed = { first = 0, n = 9 }\n", one_refuses)
    head.run()
    assert head.tally.n_done == 9
    assert head.tally.refused == {"old-node: expected the canary good"}
    assert "refused a worker on old-node" in caplog.text


def test_a_study_that_no_worker_can_run_ends_with_the_reason(tmp_path: Path) -> None:
    refusal = Answer(host="old-node", pid=1, numerics="native", canary="bad", refused="expected the canary good")
    head = Head(tmp_path, "[axes]\nseed = [1]\n", lambda _: refusal)
    with pytest.raises(EngineError, match="No worker can run this study: old-node: expected the canary good"):
        head.run()
    assert head.engine.closed_now is True


def test_the_first_canary_counts_and_an_answer_with_another_one_does_not(tmp_path: Path) -> None:
    canaries = iter(["good", "bad"])

    def with_canary(job: Job) -> Answer:
        return replace(answered(replace(job, canary=None)), canary=next(canaries, "good"))

    head = Head(tmp_path, "[axes]\nseed = { first = 0, n = 9 }\n", with_canary)
    head.run()
    assert head.canaries == ["good"]
    assert {job.canary for job in head.engine.jobs[2:]} == {"good"}
    assert "expected the canary good, computes bad (numerics " in next(iter(head.tally.refused))
    table = head.folder.rows()
    assert table is not None
    assert sorted(table.column("seed").to_pylist()) == list(range(9))


def test_a_stop_keeps_what_is_done(tmp_path: Path) -> None:
    head = Head(tmp_path, "[axes]\nseed = { first = 0, n = 100 }\n")
    head.stop.set()
    head.run()
    assert head.engine.closed_now is True
    assert head.engine.jobs == []


def test_an_error_of_the_worker_itself_ends_the_study(tmp_path: Path) -> None:
    def broken(job: Job) -> Answer:
        raise LegpushError("the kind of cell cannot be loaded")

    head = Head(tmp_path, "[axes]\nseed = [1]\n", broken)
    with pytest.raises(LegpushError, match="cannot be loaded"):
        head.run()
    assert head.engine.closed_now is True
