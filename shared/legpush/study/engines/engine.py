"""An engine as the head of a study sees it."""

from concurrent.futures import Future
from dataclasses import dataclass
from typing import Protocol

from legpush.errors import LegpushError


class WorkerLostError(LegpushError):
    """The worker of a job is gone, and the job was not finished; names what is known of it."""


@dataclass(frozen=True, kw_only=True)
class Pace:
    """How many cells an engine wants at a time."""

    batch_s: float = 1.5
    """Cells are sent in jobs that take about this long; a cell that takes longer is sent alone."""
    most_cells: int = 256
    """Most cells of a job."""
    jobs_per_slot: int = 2
    """Jobs in flight per slot: with two, one runs while the next one waits."""


class Engine(Protocol):
    """Runs jobs by calling `legpush.study.work.work` in worker processes."""

    name: str
    """As in `--on`."""
    pace: Pace
    workers_keep_rows: bool
    """Whether each worker writes its rows into the folder of the study, so that the head must not."""

    def n_slots(self) -> int:
        """Return how many jobs can run at the same time now."""

    def submit(self, job: bytes) -> "Future[bytes]":
        """Queue a job; its future has the answer.

        The future raises `WorkerLostError` if the worker died, was preempted or cannot be reached any more. Another
        exception is an error of the worker itself.
        """

    def close(self, *, now: bool) -> None:
        """End the workers: `now`, or when the jobs that are queued are done."""
