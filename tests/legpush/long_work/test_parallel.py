"""Functions that are called in threads: the order of their results, and what is kept when one fails."""

import threading
from functools import partial

import pytest

from legpush.long_work.parallel import in_parallel


@pytest.mark.parametrize("n_threads", [1, 3])
def test_results_are_in_order_and_told_once(n_threads: int) -> None:
    told: list[int] = []
    assert in_parallel([partial(int, str(n)) for n in range(20)], n_threads, told.append) == list(range(20))
    assert sorted(told) == list(range(20))


def test_results_are_told_on_the_callers_thread() -> None:
    threads: set[threading.Thread] = set()
    in_parallel([threading.current_thread] * 3, 2, lambda _: threads.add(threading.current_thread()))
    assert threads == {threading.current_thread()}


def test_when_one_fails_those_that_run_are_finished_and_told_and_no_other_begins() -> None:
    running, failed = threading.Event(), threading.Event()
    begun: list[int] = []

    def work(n: int) -> int:
        begun.append(n)
        if n == 0:
            running.set()
            assert failed.wait(20.0)
        if n == 1:
            assert running.wait(20.0)
            failed.set()
            raise KeyError(n)
        return n

    told: list[int] = []
    with pytest.raises(KeyError):
        in_parallel([partial(work, n) for n in range(50)], 2, told.append)
    assert sorted(begun) == list(range(len(begun)))
    assert sorted(told) == [n for n in sorted(begun) if n != 1]
    assert 0 in told


def test_nothing_to_call_is_nothing_to_return() -> None:
    assert in_parallel([], 2, print) == []
