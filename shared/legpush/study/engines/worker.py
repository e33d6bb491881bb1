"""`legpush study work`: the workers of this host, which run cells for the heads of studies."""

import logging
import platform
import threading
from concurrent.futures import FIRST_EXCEPTION, Future, ThreadPoolExecutor, wait
from concurrent.futures import TimeoutError as NotDone
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple

import msgspec

from legpush.bus import channels
from legpush.bus.bundles.forwarding import SharedSession
from legpush.bus.bus import Bus
from legpush.bus.session import ZenohSession, log_refused_links
from legpush.bus.status import StatusBeacon
from legpush.errors import LegpushError, MessageError
from legpush.messages import codec
from legpush.messages.common import Header
from legpush.messages.jobs import JobRequest, JobResult
from legpush.numerics.current import current
from legpush.options.study import WorkOptions
from legpush.patience import Stopwatch
from legpush.service import start_log, stop_on_signals
from legpush.study.engines.engine import WorkerLostError
from legpush.study.engines.inbox import MOST_HEADS, Inbox
from legpush.study.engines.local import LocalEngine
from legpush.study.engines.trusted import Trusted
from legpush.study.jobs import Answer, decode_job, encode

IDLE_S: Final = 0.1
"""How often the stop event and the head are looked at."""
HEAD_GONE_S: Final = 10.0
"""A job whose head shows no token for this long is ended."""

log = logging.getLogger(__name__)


def work_for_heads(options: WorkOptions) -> int:
    """Run jobs until a signal comes; returns the exit code.

    Raises:
        EndpointError: One of the endpoints cannot be listened on.
        LegpushError: The network failed.
    """
    stop = stop_on_signals()
    start_log(f"worker/{options.own_name}", "warning" if options.output.quiet else "info")
    at = options.endpoints("worker")
    if at.credentials is not None:
        log_refused_links()
    trusted = Trusted(options.cell, tuple(options.policy))
    with ExitStack() as stack:
        session = stack.enter_context(closing(ZenohSession(at, f"worker {options.own_name}", stop)))
        own: set[str] = set()
        buses = [
            stack.enter_context(
                Bus(
                    options.run,
                    "worker",
                    name,
                    at,
                    stop=stop,
                    open_session=lambda *_: SharedSession(session, own),
                    watches_links=name == options.names[0],
                )
            )
            for name in options.names
        ]
        threads = stack.enter_context(ThreadPoolExecutor(len(buses), thread_name_prefix="worker"))
        served = [threads.submit(serve_jobs, bus, trusted, stop) for bus in buses]
        log.info("%d workers wait for studies in run %s", len(buses), options.run)
        wait(served, return_when=FIRST_EXCEPTION)
        stop.set()
        for each in served:
            each.result()
    return 0


class _Asked(NamedTuple):
    """Which job of which head."""

    head: str
    number: int


@dataclass
class _Seen:
    """What was asked: an old copy of a request is no new job."""

    newest: dict[str, int] = field(default_factory=dict)
    """By head, the highest number."""

    def is_new(self, asked: _Asked) -> bool:
        """Whether this job was not begun before; then it is now."""
        if asked.number <= self.newest.get(asked.head, -1):
            return False
        self.newest.pop(asked.head, None)
        self.newest[asked.head] = asked.number
        if len(self.newest) > MOST_HEADS:
            del self.newest[next(iter(self.newest))]
        return True


def serve_jobs(bus: Bus, trusted: Trusted, stop: threading.Event) -> None:
    """Announce this worker and do its jobs, one after the other, until `stop`."""
    inbox = Inbox(bus)
    results = bus.publisher(channels.job_results(bus.run, bus.name))
    seen, done = _Seen(), None
    with _Process() as process, StatusBeacon(bus) as beacon:
        bus.announce()
        while not stop.is_set():
            request = inbox.next(IDLE_S)
            if request is None:
                continue
            head, asked = request.header, _Asked(request.header.incarnation, request.number)
            if done is not None and asked == done[0]:
                results.send(done[1])
                continue
            if not seen.is_new(asked):
                bus.tally.add("repeated", f"head {head.name}: an old job", logging.INFO)
                results.send(_built(request, b"", f"job {asked.number} was begun before, and its result is not kept"))
                continue
            if asked.number == 0:
                log.info("%s works for %s", bus.name, head.name)
            beacon.publish_status("working", detail=f"job {asked.number} of {head.name}")
            finished = _answer(bus, inbox, process, request, trusted, stop)
            if finished is not None:
                try:
                    results.send(finished)
                except MessageError as error:  # such as an answer that no message can hold
                    finished = _built(request, b"", str(error))
                    results.send(finished)
                done = asked, finished
            inbox.is_given_up(request)  # drops the copies that came before the result
            beacon.publish_status("idle", detail=f"job {asked.number} of {head.name} done")


class _Process:
    """The process that runs the cells of one worker; one that was ended is replaced with the next job."""

    def __init__(self) -> None:
        self._engine = LocalEngine(1)

    def __enter__(self) -> "_Process":
        return self

    def __exit__(self, *_: object) -> None:
        self._engine.close(now=True)

    def submit(self, job: bytes) -> "Future[bytes]":
        """Run a job."""
        return self._engine.submit(job)

    def end(self) -> None:
        """End the job that runs."""
        self._engine.close(now=True)
        self._engine = LocalEngine(1)


def _answer(
    bus: Bus, inbox: Inbox, process: _Process, request: JobRequest, trusted: Trusted, stop: threading.Event
) -> Any:
    """What makes the result of a job; None if nobody waits for it any more."""
    try:
        codec.unpack(request.job)  # refuses what takes far more memory than its bytes
        objection = trusted.objection(decode_job(request.job))
    except (MessageError, msgspec.MsgspecError, RecursionError) as error:
        objection = f"expected a job, got something else: {error}"
    if objection is not None:
        return _built(request, refusal(objection))
    future, gone = process.submit(request.job), Stopwatch()
    while not stop.is_set():
        try:
            return _built(request, future.result(IDLE_S))
        except NotDone:
            if inbox.is_given_up(request):
                log.warning("%s: the head %s waits for another job, this one ends", bus.name, request.header.name)
                process.end()
                return None
            if bus.liveliness.is_live("agent", request.header.name, request.header.incarnation):
                gone.restart()
            elif gone.tick() > HEAD_GONE_S:
                log.warning("%s: the head %s is gone, its job ends", bus.name, request.header.name)
                process.end()
                return None
        except WorkerLostError as error:
            return _built(request, b"", str(error))
        except LegpushError as error:
            return _built(request, refusal(str(error)))
    return None


def refusal(why: str) -> bytes:
    """Return the answer of a worker that runs nothing."""
    return encode(Answer(host=platform.node(), pid=0, numerics=current().name, canary=None, refused=why))


def _built(request: JobRequest, answer: bytes, reason: str = "") -> Any:
    """What makes the message of a result."""

    def build(header: Header) -> JobResult:
        return JobResult(
            header=header,
            head_incarnation=request.header.incarnation,
            number=request.number,
            ending="answered" if answer else "lost",
            answer=answer,
            reason=reason,
        )

    return build
