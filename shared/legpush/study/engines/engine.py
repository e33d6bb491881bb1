"""An engine as the head of a study sees it."""

from concurrent.futures import Future
from typing import Protocol

from legpush.errors import LegpushError


class WorkerLostError(LegpushError):
    """The worker of a job is gone, and the job was not finished; names what is known of it."""


class Engine(Protocol):
    """Runs jobs by calling `legpush.study.work.work` in worker processes."""

    name: str
    """As in `--on`."""

    def n_slots(self) -> int:
        """Return how many jobs can run at the same time now."""

    def submit(self, job: bytes) -> "Future[bytes]":
        """Queue a job; its future has the answer.

        The future raises `WorkerLostError` if the worker died, was preempted or cannot be reached any more. Another
        exception is an error of the worker itself.
        """

    def close(self, *, now: bool) -> None:
        """End the workers: `now`, or when the jobs that are queued are done."""
