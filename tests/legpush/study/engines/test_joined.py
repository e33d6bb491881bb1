"""The head of a study and workers that somebody else starts: jobs are done once, and no worker matters."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, in_directory
from legpush.bus.status import StatusBeacon
from legpush.errors import PeerError
from legpush.messages.common import Header
from legpush.messages.jobs import JobResult
from legpush.patience import Patience
from legpush.study.carry_out import Orders, carry_out
from legpush.study.engines.engine import WorkerLostError
from legpush.study.engines.joined import JoinedEngine
from legpush.study.engines.trusted import Trusted
from legpush.study.engines.worker import serve_jobs
from legpush.study.jobs import Failure, decode_answer, encode
from legpush.study.work import work
from tests.legpush.fakes import eventually
from tests.legpush.study.engines.test_local import job_of, values
from tests.legpush.study.parts import STUB, study_of

RUN = "study"
IMPATIENT = Patience(deadline_s=60.0, resend_s=0.2, resend_at_most_s=0.5, max_restarts=0, leave_s=0.5)
TRUSTED = Trusted(cell=STUB)


@pytest.fixture
def there(tmp_path: Path) -> Endpoints:
    """Where the head listens."""
    tmp_path.chmod(0o700)
    return Endpoints(listen=in_directory(tmp_path, "agent").listen)


@contextmanager
def head(there: Endpoints, find_s: float = 20.0) -> Iterator[JoinedEngine]:
    """A head."""
    engine = JoinedEngine(RUN, there, IMPATIENT, find_s)
    try:
        yield engine
    finally:
        engine.close(now=True)


@contextmanager
def worker(there: Endpoints, name: str, trusted: Trusted = TRUSTED) -> Iterator[Bus]:
    """A worker on a thread; its cells run in a process."""
    stop = threading.Event()
    with Bus(RUN, "worker", name, Endpoints(connect=there.listen), stop=stop) as bus:
        serving = threading.Thread(target=serve_jobs, args=(bus, trusted, stop))
        serving.start()
        try:
            yield bus
        finally:
            stop.set()
            serving.join(30.0)


def test_jobs_run_side_by_side_in_all_workers(there: Endpoints) -> None:
    with head(there) as engine, worker(there, "a"), worker(there, "b"):
        assert eventually(lambda: engine.n_slots() == 2)
        answers = [decode_answer(f.result(60.0)) for f in [engine.submit(job_of(n, seconds=1.0)) for n in (1, 2, 3)]]
        assert [answer.rows[0].columns["value"] for answer in answers] == [1.0, 2.0, 3.0]
        assert len({answer.pid for answer in answers}) == 2


def test_a_worker_may_come_later_and_a_job_waits_for_it(there: Endpoints) -> None:
    with head(there) as engine:
        waiting = engine.submit(job_of(4))
        time.sleep(0.3)
        with worker(there, "late"):
            assert values(waiting.result(60.0)) == [4.0]


def test_the_job_of_a_worker_that_leaves_is_lost_and_another_one_does_the_next(there: Endpoints) -> None:
    with head(there) as engine, ExitStack() as leaving:
        leaving.enter_context(worker(there, "a"))
        assert eventually(lambda: engine.n_slots() == 1)
        lost = engine.submit(job_of(1, seconds=60.0))
        assert eventually(lambda: "a" in engine._links)
        time.sleep(0.5)
        leaving.close()
        with pytest.raises(WorkerLostError, match="worker/a"):
            lost.result(30.0)
        with worker(there, "b"):
            assert values(engine.submit(job_of(2)).result(60.0)) == [2.0]


def test_a_worker_whose_process_dies_says_so_and_goes_on(there: Endpoints) -> None:
    with head(there) as engine, worker(there, "a"):
        with pytest.raises(WorkerLostError, match=r"worker/a: Worker \d+ on this machine ended with exit code 7"):
            engine.submit(job_of(1, 2, kill_at=2)).result(60.0)
        assert values(engine.submit(job_of(3)).result(60.0)) == [3.0]


def test_a_worker_that_was_started_again_under_its_name_has_lost_the_job(there: Endpoints) -> None:
    with head(there) as engine, ExitStack() as leaving:
        leaving.enter_context(worker(there, "a"))
        lost = engine.submit(job_of(1, seconds=60.0))
        assert eventually(lambda: "a" in engine._links)
        time.sleep(0.5)
        leaving.close()
        with worker(there, "a"):
            with pytest.raises(WorkerLostError, match="worker/a"):
                lost.result(30.0)
            assert values(engine.submit(job_of(2)).result(60.0)) == [2.0]


def test_a_worker_that_does_not_run_this_code_refuses_and_gets_no_further_job(there: Endpoints) -> None:
    with head(there) as engine, worker(there, "a", Trusted()):
        answer = decode_answer(engine.submit(job_of(1)).result(60.0))
        assert answer.refused == f"expected cells of an installed kind, or --cell {STUB} with `legpush study work`"
        assert engine.n_slots() == 0
        with worker(there, "b"):
            assert values(engine.submit(job_of(2)).result(60.0)) == [2.0]


@contextmanager
def evil_worker(there: Endpoints, answer: Callable[[bytes], bytes]) -> Iterator[None]:
    """A worker that makes its answer to its first job as a test says."""

    def answer_once() -> None:
        requests = bus.subscribe(channels.job_requests(RUN, "evil"))
        results = bus.publisher(channels.job_results(RUN, "evil"))
        bus.announce()
        request = requests.next(20.0)
        assert request is not None
        made = answer(request.job)

        def build(header: Header) -> JobResult:
            return JobResult(
                header=header,
                head_incarnation=request.header.incarnation,
                number=request.number,
                ending="answered",
                answer=made,
            )

        results.send(build)

    with Bus(RUN, "worker", "evil", Endpoints(connect=there.listen)) as bus, StatusBeacon(bus):
        answering = threading.Thread(target=answer_once)
        answering.start()
        yield
        answering.join(10.0)


def altered(**changes: Any) -> Callable[[bytes], bytes]:
    """Return what makes an answer that is right but for these fields; each is made of the rows."""

    def answer(job: bytes) -> bytes:
        right = decode_answer(work(job))
        return encode(replace(right, **{field: change(right.rows) for field, change in changes.items()}))

    return answer


FOREIGN = Failure(cell="another", error="ValueError", traceback="")


@pytest.mark.parametrize(
    ("answer", "why"),
    [
        (lambda _: b"\xc1", "Expected one MessagePack map"),
        (altered(rows=lambda _: ()), "expected the 2 cells of the job, each once, got 0, with 2 missing"),
        (altered(rows=lambda rows: rows[:1]), "got 1, with 1 missing and 0 of no use"),
        (altered(rows=lambda rows: (*rows, rows[0])), "got 3, with 0 missing and 1 of no use"),
        (altered(failures=lambda _: (FOREIGN,)), "got 3, with 0 missing and 1 of no use"),
        (altered(rows=lambda rows: (replace(rows[0], columns=rows[1].columns), rows[1])), "in its own row, got"),
    ],
    ids=["unreadable", "nothing", "too few", "one twice", "a foreign failure", "a foreign row"],
)
def test_a_worker_whose_answer_is_not_that_to_its_job_is_left(
    there: Endpoints, answer: Callable[[bytes], bytes], why: str
) -> None:
    with head(there) as engine, evil_worker(there, answer):
        with pytest.raises(WorkerLostError, match=f"worker/evil gave an answer of no use: .*{why}"):
            engine.submit(job_of(1, 2)).result(30.0)
        assert engine.n_slots() == 0


def test_cells_whose_answers_are_too_large_together_are_done_alone(
    there: Endpoints, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = study_of("[axes]\nseed = { first = 0, n = 40 }\n")
    monkeypatch.setattr("legpush.messages.codec.MAX_MESSAGE_BYTES", len(job_of(*range(20))) + 1000)

    def begin(_: Path) -> JoinedEngine:
        assert eventually(lambda: engine.n_slots() == 1)
        return engine

    with head(there) as engine, worker(there, "a"):
        tally = carry_out(study, tmp_path / "out", Orders(engine=begin, stop=threading.Event(), again="again"))
    assert (tally.n_done, tally.n_failed) == (40, 0)
    assert tally.n_retried > 0


def test_two_heads_share_the_workers(there: Endpoints, tmp_path: Path) -> None:
    other = Endpoints(listen=(f"unixsock-stream/{tmp_path}/other.sock",))
    both = Endpoints(listen=(*there.listen, *other.listen))
    with head(there) as one, head(other) as two, worker(both, "a"):
        first, second = one.submit(job_of(1, seconds=0.5)), two.submit(job_of(2, seconds=0.5))
        assert (values(first.result(60.0)), values(second.result(60.0))) == ([1.0], [2.0])


def test_no_worker_for_a_while_is_an_error_that_says_how_to_start_one(there: Endpoints) -> None:
    told = r"Expected a worker in run study within 0.2 s, found none, .* --run study"
    with head(there, find_s=0.2) as engine, pytest.raises(PeerError, match=told):
        eventually(lambda: engine.n_slots() > 0)


def test_workers_of_one_name_are_named_and_others_do_the_jobs(there: Endpoints) -> None:
    with head(there, find_s=0.2) as engine, worker(there, "robot"), worker(there, "robot"):
        told = "found 2 processes named robot, which need names of their own, listening on"
        assert eventually(lambda: len(engine._bus.liveliness.live("worker")) == 2)
        with pytest.raises(PeerError, match=told):
            eventually(lambda: engine.n_slots() > 0)
        with worker(there, "b"):
            assert [values(engine.submit(job_of(n)).result(60.0)) for n in (1, 2)] == [[1.0], [2.0]]


def test_a_head_that_leaves_ends_what_waits(there: Endpoints) -> None:
    with head(there) as engine:
        waiting = engine.submit(job_of(1))
        engine.close(now=True)
        assert waiting.cancelled() or isinstance(waiting.exception(10.0), WorkerLostError)
