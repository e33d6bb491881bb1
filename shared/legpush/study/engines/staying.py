"""An engine that stays from one study to the next, so that its workers start once."""

from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager

from legpush.study.engines.engine import Engine


class StayingEngine:
    """Another engine, which ends when its context is left, or when a study that uses it is stopped."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self.name = engine.name
        self.pace = engine.pace
        self.workers_keep_rows = engine.workers_keep_rows

    def n_slots(self) -> int:
        """Return how many jobs can run at the same time now."""
        return self._engine.n_slots()

    def submit(self, job: bytes) -> "Future[bytes]":
        """Queue a job; see `Engine.submit`."""
        return self._engine.submit(job)

    def close(self, *, now: bool) -> None:
        """End the workers `now`; without it they stay."""
        if now:
            self._engine.close(now=True)


@contextmanager
def staying(engine: Engine) -> Iterator[StayingEngine]:
    """Yield the engine for several studies, and end its workers afterwards."""
    try:
        yield StayingEngine(engine)
    finally:
        engine.close(now=False)
