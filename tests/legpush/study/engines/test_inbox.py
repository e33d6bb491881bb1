"""The jobs that wait for a worker: one of each head that is there, the newest."""

from collections.abc import Iterator

import pytest

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.messages.common import Header
from legpush.messages.jobs import JobRequest
from legpush.study.engines import inbox as module
from legpush.study.engines.inbox import Inbox
from tests.legpush.bus.memory_session import RUN, MemoryNetwork


@pytest.fixture
def network() -> MemoryNetwork:
    """Nobody is there yet."""
    return MemoryNetwork()


@pytest.fixture
def worker(network: MemoryNetwork) -> Iterator[Bus]:
    """The bus of a worker."""
    with network.bus("worker", "w") as bus:
        yield bus


@pytest.fixture
def inbox(worker: Bus) -> Inbox:
    """Nobody has asked yet."""
    return Inbox(worker)


class Head:
    """Asks a worker by hand."""

    def __init__(self, bus: Bus) -> None:
        bus.announce()
        self._requests = bus.publisher(channels.job_requests(RUN, "w"))

    def ask(self, *numbers: int) -> None:
        """Ask for jobs."""
        for number in numbers:

            def build(header: Header, number: int = number) -> JobRequest:
                return JobRequest(header=header, number=number, job=b"")

            self._requests.send(build)


def asked(request: JobRequest | None) -> tuple[str, int] | None:
    """Head and number of a request."""
    return None if request is None else (request.header.name, request.number)


def test_each_head_has_one_job_in_turn_and_its_newest(network: MemoryNetwork, inbox: Inbox) -> None:
    with network.bus("agent", "a") as a, network.bus("agent", "b") as b:
        first, second = Head(a), Head(b)
        first.ask(3, 4)
        second.ask(7)
        first.ask(5, 4, 3)
        assert [asked(inbox.next(0.0)) for _ in range(3)] == [("a", 5), ("b", 7), None]


def test_copies_of_a_running_job_are_dropped_and_a_later_one_gives_it_up(network: MemoryNetwork, inbox: Inbox) -> None:
    with network.bus("agent", "a") as a, network.bus("agent", "b") as b:
        first, second = Head(a), Head(b)
        first.ask(5)
        running = inbox.next(0.0)
        assert running is not None
        first.ask(5, 5, 4)
        second.ask(9)
        assert not inbox.is_given_up(running)
        assert [asked(inbox.next(0.0)) for _ in range(2)] == [("b", 9), None]
        first.ask(6)
        assert inbox.is_given_up(running)
        assert asked(inbox.next(0.0)) == ("a", 6)


def test_a_job_whose_head_is_not_there_or_leaves_is_left_out(
    network: MemoryNetwork, worker: Bus, inbox: Inbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    with network.bus("agent", "a") as a, network.bus("agent", "ghost") as ghost, network.bus("agent", "b") as b:
        monkeypatch.setattr(ghost, "announce", lambda: None)
        Head(ghost).ask(1)
        Head(a).ask(1)
        running = inbox.next(0.0)
        assert running is not None
        assert running.header.name == "a"
        assert worker.tally["no_token"] == 1
        Head(b).ask(1)
        assert not inbox.is_given_up(running)
    assert inbox.next(0.0) is None


def test_jobs_of_many_heads_do_not_fill_the_memory(
    network: MemoryNetwork, worker: Bus, inbox: Inbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MOST_HEADS", 2)
    with network.bus("agent", "a") as a, network.bus("agent", "b") as b, network.bus("agent", "c") as c:
        for head in (Head(a), Head(b), Head(c)):
            head.ask(1)
        assert [asked(inbox.next(0.0)) for _ in range(3)] == [("a", 1), ("b", 1), None]
    assert worker.tally["overflow"] == 1
