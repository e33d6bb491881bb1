"""Runs jobs in the process of the head, one after the other: under a debugger, a profiler or an emulator."""

from concurrent.futures import Future

from legpush.errors import LegpushError
from legpush.study.engines.engine import Pace
from legpush.study.work import work


class InlineEngine:
    """An engine without workers. A cell that ends its process ends the head."""

    name = "inline"
    pace = Pace(batch_s=0.0, jobs_per_slot=1)
    workers_keep_rows = False

    def n_slots(self) -> int:
        """Return 1."""
        return 1

    def submit(self, job: bytes) -> "Future[bytes]":
        """Run a job at once, and return its answer; see `Engine.submit`."""
        future: Future[bytes] = Future()
        try:
            future.set_result(work(job))
        except LegpushError as error:
            future.set_exception(error)
        return future

    def close(self, *, now: bool) -> None:
        """Do nothing: no job runs between two calls."""
