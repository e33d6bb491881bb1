"""A worker for heads on the bus: which jobs it runs, that it runs each once, and when it ends one."""

import threading
import time
from collections.abc import Iterator

import pytest

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.errors import ConfigError
from legpush.messages.common import Header
from legpush.messages.jobs import JobRequest, JobResult
from legpush.options.study import WorkOptions
from legpush.study.engines import worker as module
from legpush.study.engines.trusted import Trusted
from legpush.study.engines.worker import serve_jobs
from legpush.study.jobs import decode_answer
from tests.legpush.bus.memory_session import RUN, MemoryNetwork
from tests.legpush.fakes import eventually
from tests.legpush.study.engines.test_local import job_of, values
from tests.legpush.study.parts import STUB


class Head:
    """Sends requests by hand, and keeps what comes back."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self.results = bus.subscribe(channels.job_results(RUN, "w"))
        self._requests = bus.publisher(channels.job_requests(RUN, "w"))
        bus.announce()

    def send(self, number: int, job: bytes) -> None:
        """Ask."""

        def build(header: Header) -> JobRequest:
            return JobRequest(header=header, number=number, job=job)

        self._requests.send(build)

    def next(self) -> JobResult:
        """The next result for this head."""
        while (result := self.results.next(30.0)) is not None:
            if result.head_incarnation == self._bus.incarnation:
                return result
        raise AssertionError("Expected a result within 30 s")


@pytest.fixture
def network() -> MemoryNetwork:
    """Nobody is there yet."""
    return MemoryNetwork()


@pytest.fixture
def served(network: MemoryNetwork) -> Iterator[Bus]:
    """A worker."""
    stop = threading.Event()
    with network.bus("worker", "w") as bus:
        serving = threading.Thread(target=serve_jobs, args=(bus, Trusted(cell=STUB), stop))
        serving.start()
        yield bus
        stop.set()
        serving.join(30.0)
        assert not serving.is_alive()


def test_a_job_that_is_asked_again_is_done_once_and_answered_again(network: MemoryNetwork, served: Bus) -> None:
    with network.bus("agent", "head") as bus:
        head = Head(bus)
        head.send(0, job_of(1, seconds=0.5))
        head.send(0, job_of(1, seconds=0.5))
        first = head.next()
        assert values(first.answer) == [1.0]
        assert head.results.next(0.5) is None
        head.send(0, job_of(1, seconds=0.5))
        again = head.next()
        assert (again.answer, again.number) == (first.answer, 0)
        head.send(1, job_of(2))
        assert values(head.next().answer) == [2.0]
        head.send(0, job_of(1))
        lost = head.next()
        assert (lost.number, lost.ending, lost.answer) == (0, "lost", b"")
        assert lost.reason == "job 0 was begun before, and its result is not kept"
        assert served.tally["repeated"] == 1


def test_a_head_whose_result_is_not_kept_any_more_is_told_so(network: MemoryNetwork, served: Bus) -> None:
    del served
    with network.bus("agent", "head") as bus, network.bus("agent", "other") as other_bus:
        head, other = Head(bus), Head(other_bus)
        head.send(0, job_of(1))
        assert values(head.next().answer) == [1.0]
        other.send(0, job_of(2))
        assert values(other.next().answer) == [2.0]
        head.send(0, job_of(1))
        assert head.next().ending == "lost"


def test_who_shows_no_token_gets_nothing(network: MemoryNetwork, served: Bus, monkeypatch: pytest.MonkeyPatch) -> None:
    with network.bus("agent", "ghost") as bus:
        monkeypatch.setattr(bus, "announce", lambda: None)
        Head(bus).send(0, job_of(1))
        assert eventually(lambda: served.tally["no_token"] == 1)


def test_a_job_whose_head_is_gone_is_ended(
    network: MemoryNetwork, served: Bus, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(module, "HEAD_GONE_S", 0.3)
    with network.bus("agent", "gone") as bus:
        Head(bus).send(0, job_of(1, seconds=60.0))
        time.sleep(0.5)
    assert eventually(lambda: "the head gone is gone, its job ends" in caplog.text)
    with network.bus("agent", "next") as bus:
        head = Head(bus)
        head.send(0, job_of(2))
        assert values(head.next().answer) == [2.0]


def test_a_head_that_asks_for_a_later_job_waits_no_more_for_the_one_that_runs(
    network: MemoryNetwork, served: Bus
) -> None:
    del served
    with network.bus("agent", "head") as bus:
        head = Head(bus)
        head.send(0, job_of(1, seconds=60.0))
        time.sleep(0.3)
        head.send(1, job_of(2))
        result = head.next()
        assert (result.number, values(result.answer)) == (1, [2.0])


def test_copies_of_a_long_job_do_not_keep_out_the_job_of_another_head(network: MemoryNetwork, served: Bus) -> None:
    with network.bus("agent", "head") as bus, network.bus("agent", "other") as other_bus:
        head, other, long = Head(bus), Head(other_bus), job_of(1, seconds=1.2)
        for _ in range(3):
            for _ in range(400):
                head.send(0, long)
            time.sleep(0.3)
        other.send(0, job_of(5))
        assert values(other.next().answer) == [5.0]
        assert values(head.next().answer) == [1.0]
        assert "overflow" not in served.tally.as_dict()


@pytest.mark.parametrize(
    "payload",
    [b"", b"\xc1", b"\x80", b"\x91" * 100_000, b"\xdd\x00\x20\x00\x00" + 2**21 * b"\x80"],
    ids=["empty", "malformed", "without fields", "deep", "many parts"],
)
def test_what_is_no_job_is_refused_and_the_worker_goes_on(network: MemoryNetwork, served: Bus, payload: bytes) -> None:
    del served
    with network.bus("agent", "head") as bus:
        head = Head(bus)
        head.send(0, payload)
        assert "expected a job, got something else" in (decode_answer(head.next().answer).refused or "")
        head.send(1, job_of(2))
        assert values(head.next().answer) == [2.0]


def test_an_answer_that_no_message_can_hold_is_lost_and_the_worker_goes_on(
    network: MemoryNetwork, served: Bus, monkeypatch: pytest.MonkeyPatch
) -> None:
    del served
    many = job_of(*range(20))
    monkeypatch.setattr("legpush.messages.codec.MAX_MESSAGE_BYTES", len(many) + 1000)
    with network.bus("agent", "head") as bus:
        head = Head(bus)
        head.send(0, many)
        result = head.next()
        assert result.ending == "lost"
        assert f"Expected at most {len(many) + 1000} bytes" in result.reason
        head.send(1, job_of(2))
        assert values(head.next().answer) == [2.0]


def test_workers_have_names_by_number_and_wrong_options_are_refused() -> None:
    assert WorkOptions(name="desk", workers=1).names == ("desk",)
    assert WorkOptions(name="desk", workers=3).names == ("desk-1", "desk-2", "desk-3")
    for wrong, flag in (({"workers": 0}, "--workers"), ({"name": "a b"}, "--name"), ({"run": ""}, "--run")):
        with pytest.raises(ConfigError, match=f"Expected .* for {flag}"):
            WorkOptions(**wrong)


def test_workers_of_a_host_share_a_session_tell_about_links_once_and_do_not_see_one_another(
    network: MemoryNetwork, monkeypatch: pytest.MonkeyPatch
) -> None:
    stop, seen = threading.Event(), []
    all_there = threading.Barrier(3)

    def serve(bus: Bus, *_: object) -> None:
        bus.announce()
        all_there.wait(30.0)
        seen.append((bus._watches_links, bus.liveliness.live()))

    monkeypatch.setattr(module, "stop_on_signals", lambda: stop)
    monkeypatch.setattr(module, "start_log", lambda *_: None)
    monkeypatch.setattr(module, "ZenohSession", lambda at, who, _: network.open_session(at, who))
    monkeypatch.setattr(module, "serve_jobs", serve)
    assert module.work_for_heads(WorkOptions(run=RUN, name="w", workers=3)) == 0
    assert sorted(seen) == [(False, []), (False, []), (True, [])]
    assert network.sessions == []


@pytest.mark.parametrize(
    ("host", "name"),
    [("desk", "desk"), ("robot.local", "robot-local"), ("", "main"), (70 * "x", 59 * "x"), ("ü", "main")],
)
def test_workers_without_a_name_have_that_of_their_host(host: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("platform.node", lambda: host)
    assert WorkOptions(workers=1).names == (name,)
    assert WorkOptions(workers=1024).names[-1] == f"{name}-1024"
