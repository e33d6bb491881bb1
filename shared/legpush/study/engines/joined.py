"""Runs jobs in the workers of a run, which may come, go and be replaced at any time, on any host."""

import threading
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import Final
from uuid import uuid4

import msgspec

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, listing
from legpush.bus.exchange import Exchange
from legpush.bus.ports import Publisher
from legpush.errors import LegpushError, MessageError, PeerError
from legpush.messages import codec
from legpush.messages.common import Header
from legpush.messages.jobs import JobRequest, JobResult
from legpush.patience import Patience, Stopwatch
from legpush.study.engines.engine import Pace, WorkerLostError
from legpush.study.engines.pool import Pool
from legpush.study.jobs import Answer, decode_answer, decode_job
from legpush.study.rows import CELL

MOST_JOBS: Final = 2048
"""Most jobs that run or wait at a time."""
PATIENCE: Final = Patience(deadline_s=1e9, resend_s=0.5, resend_at_most_s=5.0, max_restarts=0)
"""A job may take days. A worker that was started again does not know the job of the one before."""
FIND_S: Final = 60.0
"""Longest time without any worker."""


class JoinedEngine:
    """An engine whose workers somebody else starts: `legpush study work`.

    A worker that is gone for some seconds has lost its job. One that has other code or computes other bits than the
    study gets no further job, and neither does one whose answer cannot be read, or is not that to its job.
    Several workers of one name get none.
    """

    name = "join"
    pace = Pace()
    workers_keep_rows = False

    def __init__(
        self,
        run: str,
        endpoints: Endpoints,
        patience: Patience = PATIENCE,
        find_s: float = FIND_S,
        *,
        stop: threading.Event | None = None,
    ) -> None:
        """Begin to look for workers of this run; the patience is that with one job.

        `stop` ends waiting for a router; what else waits is ended by `close`.

        Raises:
            EndpointError: One of the endpoints cannot be listened on.
            StopRequestedError: `stop` was set before a router was there.
        """
        self._patience = patience
        self._find_s = find_s
        self._stop = threading.Event()
        self._stack = ExitStack()
        self._bus = self._stack.enter_context(Bus(run, "agent", f"study-{uuid4().hex[:12]}", endpoints, stop=stop))
        self._bus.follow("worker")
        self._bus.announce()
        self._threads = ThreadPoolExecutor(MOST_JOBS, thread_name_prefix="job")
        self._pool = Pool(self._bus)
        self._links: dict[str, _Link] = {}
        self._alone = Stopwatch()

    def n_slots(self) -> int:
        """Return how many workers there are.

        Raises:
            PeerError: There has been none for a while.
        """
        n = len(self._pool)
        if n:
            self._alone.restart()
        elif self._alone.tick() > self._find_s:
            raise PeerError(self._nobody())
        return n

    def submit(self, job: bytes) -> "Future[bytes]":
        """Queue a job; see `Engine.submit`."""
        return self._threads.submit(self._run, job)

    def close(self, *, now: bool) -> None:
        """Leave the run: `now`, or when the jobs that are queued are done. A worker whose head is gone ends its job."""
        if now:
            self._stop.set()
            self._pool.close()
        self._threads.shutdown(cancel_futures=now)
        self._stack.close()

    def _run(self, job: bytes) -> bytes:
        with self._worker() as link:
            result = link.ask(job)
            worker = result.header.name
            if result.ending == "lost":
                raise WorkerLostError(f"worker/{worker}: {result.reason}")
            try:
                answer = _answer_to(job, result.answer)
            except (MessageError, msgspec.MsgspecError, RecursionError) as error:
                self._pool.exclude(worker, result.header.incarnation)
                raise WorkerLostError(f"worker/{worker} gave an answer of no use: {error}") from error
            if answer.refused is not None:
                self._pool.exclude(worker, result.header.incarnation)
            return result.answer

    @contextmanager
    def _worker(self) -> Iterator["_Link"]:
        """Wait for a worker that has nothing to do, and keep it for a while."""
        name = self._pool.take()
        try:
            if name not in self._links:
                self._links[name] = _Link(self._bus, name, self._patience, self._stop)
            yield self._links[name]
        finally:
            self._pool.give_back(name)

    def _nobody(self) -> str:
        bus = self._bus
        others = bus.liveliness.other_versions("worker")
        found = [f"{name} of another version, with protocol {protocol}" for name, protocol in sorted(others.items())]
        found += self._pool.left_out()
        return (
            f"Expected a worker in run {bus.run} within {self._find_s:g} s, found {', '.join(found) or 'none'}, "
            f"listening on {listing(bus.endpoints.listen)}, connecting to {listing(bus.endpoints.connect)}; "
            f"`legpush study work --run {bus.run}` starts workers"
        )


def _answer_to(job: bytes, payload: bytes) -> Answer:
    """Return the answer to a job: a refusal, or a row or a failure of each of its cells.

    Raises:
        MessageError: It is too large, or has other cells.
        msgspec.MsgspecError: It is no answer.
    """
    codec.unpack(payload)  # refuses what takes far more memory than its bytes
    answer = decode_answer(payload)
    if answer.refused is not None:
        return answer
    for row in answer.rows:
        if (named := row.columns.get(CELL)) != row.cell:
            raise MessageError(f"expected the cell {row.cell} in its own row, got {named!r}")
    expected = Counter(task.cell for task in decode_job(job).tasks)
    got = Counter([row.cell for row in answer.rows] + [failure.cell for failure in answer.failures])
    if got != expected:
        raise MessageError(
            f"expected the {expected.total()} cells of the job, each once, got {got.total()}, with "
            f"{(expected - got).total()} missing and {(got - expected).total()} of no use"
        )
    return answer


class _Link:
    """Asks one worker, one job at a time."""

    def __init__(self, bus: Bus, name: str, patience: Patience, stop: threading.Event) -> None:
        self._bus = bus
        results = bus.subscribe(channels.job_results(bus.run, name))
        self._exchange = Exchange(bus, results, ("worker", name), patience, stop, may_leave=lambda: True)
        self._requests: Publisher[JobRequest] = bus.publisher(channels.job_requests(bus.run, name))
        self._number = -1

    def ask(self, job: bytes) -> JobResult:
        """Return the result of a job.

        Raises:
            WorkerLostError: The worker is gone, was started again, or this process stops.
        """
        self._number += 1
        number = self._number
        self._exchange.forget_peer()

        def build(header: Header) -> JobRequest:
            return JobRequest(header=header, number=number, job=job)

        def fits(result: JobResult) -> bool:
            return (result.head_incarnation, result.number) == (self._bus.incarnation, number)

        try:
            return self._exchange.ask(f"job {number}", partial(self._requests.send, build), fits)
        except LegpushError as error:
            raise WorkerLostError(str(error)) from error
