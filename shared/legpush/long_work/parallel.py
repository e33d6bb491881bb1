"""Calls functions in threads, and loses no result that is finished when one of them fails."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from typing import TypeVar

T = TypeVar("T")


def in_parallel(calls: Sequence[Callable[[], T]], n_threads: int, on_result: Callable[[T], None]) -> list[T]:
    """Call the functions, `n_threads` at a time; return their results in the order of the functions.

    `on_result` is called on the caller's thread with each result as it comes. If a function raises an error, no other
    one begins, those that run are finished, their results are told too, and the error is raised.
    """
    told: set[Future[T]] = set()

    def tell(future: Future[T]) -> None:
        told.add(future)
        on_result(future.result())

    pool = ThreadPoolExecutor(n_threads)
    futures = [pool.submit(call) for call in calls]
    try:
        for future in as_completed(futures):
            tell(future)
    finally:
        pool.shutdown(cancel_futures=True)
        for future in futures:
            if future not in told and not future.cancelled() and future.exception() is None:
                tell(future)
    return [future.result() for future in futures]
