"""Which workers of a run get jobs: each one job at a time, those that are fit, and those that can be asked alone."""

import threading
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from unittest.mock import Mock

import pytest

from legpush.bus.bus import Bus
from legpush.study.engines.engine import WorkerLostError
from legpush.study.engines.pool import Pool
from tests.legpush.bus.memory_session import MemoryNetwork
from tests.legpush.fakes import eventually


@pytest.fixture
def network() -> MemoryNetwork:
    """Nobody is there yet."""
    return MemoryNetwork()


@pytest.fixture
def bus(network: MemoryNetwork) -> Iterator[Bus]:
    """The bus of a head."""
    with network.bus("agent", "head") as bus:
        yield bus


@pytest.fixture
def pool(bus: Bus) -> Iterator[Pool]:
    """The pool of a head; its waits end with the test."""
    pool = Pool(bus)
    yield pool
    pool.close()


def waiting(pool: Pool, n: int) -> list["Future[str]"]:
    """Threads that wait for a worker each."""
    threads = ThreadPoolExecutor(n)
    futures = [threads.submit(pool.take) for _ in range(n)]
    threads.shutdown(wait=False)
    assert eventually(lambda: len(pool._changed._waiters) == n)  # type: ignore[attr-defined]
    return futures


def test_who_waits_is_woken_by_a_worker_that_comes_and_by_one_that_is_given_back(
    network: MemoryNetwork, pool: Pool
) -> None:
    futures = waiting(pool, 3)
    with network.bus("worker", "a") as worker:
        worker.announce()
        for n in (1, 2, 3):
            assert eventually(lambda: sum(future.done() for future in futures) == n)  # noqa: B023 - called at once
            assert len(pool) == 1
            pool.give_back("a")
    assert [future.result(1.0) for future in futures] == ["a", "a", "a"]
    assert len(pool) == 0


def test_waiting_looks_at_no_worker(
    network: MemoryNetwork, bus: Bus, pool: Pool, monkeypatch: pytest.MonkeyPatch
) -> None:
    with network.bus("worker", "a") as worker:
        worker.announce()
        assert pool.take() == "a"
        looks = Mock(wraps=bus.liveliness.live)
        monkeypatch.setattr(bus.liveliness, "live", looks)
        futures = waiting(pool, 20)
        threading.Event().wait(0.5)
        assert len(pool) == 1
        looks.assert_not_called()
        pool.close()
        assert all(isinstance(future.exception(10.0), WorkerLostError) for future in futures)


def test_several_workers_of_one_name_get_no_job_until_one_is_left(
    network: MemoryNetwork, pool: Pool, caplog: pytest.LogCaptureFixture
) -> None:
    with network.bus("worker", "robot") as one:
        one.announce()
        assert len(pool) == 1
        with network.bus("worker", "robot") as other:
            other.announce()
            assert len(pool) == 0
            assert pool.left_out() == ["2 processes named robot, which need names of their own"]
            assert "worker/robot: expected one process of this name, found 2; none gets a job" in caplog.text
            (future,) = waiting(pool, 1)
        assert future.result(10.0) == "robot"


def test_an_unfit_worker_gets_no_job_but_the_next_one_of_its_name_does(network: MemoryNetwork, pool: Pool) -> None:
    with network.bus("worker", "a") as worker:
        worker.announce()
        pool.exclude(pool.take(), worker.incarnation)
        pool.give_back("a")
        assert len(pool) == 0
        assert pool.left_out() == ["a, which was refused"]
    with network.bus("worker", "a") as worker:
        worker.announce()
        assert pool.take() == "a"
        assert pool.left_out() == []
