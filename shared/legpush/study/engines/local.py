"""Runs jobs in processes on this machine.

Each worker has a pipe of its own, and the kernel closes its end when it is killed. So a worker that dies at any moment,
even within an answer, costs its present job only. The pools of `concurrent.futures`, loky and pebble keep the writing
end of a worker's pipe open elsewhere, or share a lock between workers: a kill at the wrong moment blocks or breaks all.
"""

import os
import signal
import sys
import threading
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Final

from legpush.entry.interrupts import deaf_children
from legpush.errors import LegpushError
from legpush.processes.environment import child_environment
from legpush.processes.parent_watch import die_with
from legpush.study.engines.engine import Pace, WorkerLostError
from legpush.study.work import work

SPAWN: Final = get_context("spawn")
"""A forked process would share the threads' state of the numerical libraries."""


class LocalEngine:
    """A number of worker processes, each driven by a thread that waits for its answers."""

    name = "local"
    pace = Pace()
    workers_keep_rows = False

    def __init__(self, n_workers: int) -> None:
        """Start nothing yet: a worker starts with its first job."""
        os.environ.update(child_environment(os.environ))
        self._n_workers = n_workers
        self._threads = ThreadPoolExecutor(n_workers, thread_name_prefix="worker")
        self._own = threading.local()
        self._lock = threading.Lock()
        self._workers: set[_Worker] = set()
        self._closed = False

    def n_slots(self) -> int:
        """Return the number of workers."""
        return self._n_workers

    def submit(self, job: bytes) -> "Future[bytes]":
        """Queue a job; see `Engine.submit`."""
        return self._threads.submit(self._run, job)

    def close(self, *, now: bool) -> None:
        """End the workers: `now`, or when the jobs that are queued are done."""
        if now:
            with self._lock:
                self._closed = True
                for worker in self._workers:
                    worker.kill()
        self._threads.shutdown(cancel_futures=now)
        for worker in self._workers:
            worker.end()

    def _run(self, job: bytes) -> bytes:
        """Run a job on the worker of this thread, which is replaced if it died."""
        worker: _Worker | None = getattr(self._own, "worker", None)
        if worker is None:
            worker = self._start()
        try:
            return worker.answer(job)
        except WorkerLostError:
            with self._lock:
                self._workers.discard(worker)
            self._own.worker = None
            raise

    def _start(self) -> "_Worker":
        with self._lock:
            if self._closed:
                raise WorkerLostError("The engine is closed")
            worker = _Worker()
            self._workers.add(worker)
        self._own.worker = worker
        return worker


class _Worker:
    """A worker process and the pipe to it."""

    def __init__(self) -> None:
        self._pipe, theirs = SPAWN.Pipe()
        self._process = SPAWN.Process(target=serve, args=(theirs, os.getpid()), daemon=True)
        with deaf_children():
            self._process.start()
        theirs.close()

    def answer(self, job: bytes) -> bytes:
        """Wait for the answer to a job.

        Raises:
            WorkerLostError: The worker died.
            LegpushError: The worker cannot do this job.
        """
        try:
            self._pipe.send(job)
            answer = self._pipe.recv()
        except (EOFError, OSError) as error:
            self.end()
            code = self._process.exitcode
            how = signal.Signals(-code).name if code is not None and code < 0 else f"exit code {code}"
            raise WorkerLostError(f"Worker {self._process.pid} on this machine ended with {how}") from error
        if isinstance(answer, bytes):
            return answer
        raise LegpushError(str(answer))

    def kill(self) -> None:
        """End the process in the middle of its work."""
        self._process.kill()

    def end(self) -> None:
        """Let an idle process end, and wait for that."""
        with suppress(OSError):
            self._pipe.close()
        self._process.join()


def serve(pipe: Connection, parent: int) -> None:
    """Answer jobs until the other end of the pipe is closed: the main function of a worker process."""
    if not die_with(parent):
        sys.exit(1)
    while True:
        try:
            job = pipe.recv()
        except EOFError:
            return
        try:
            answer: bytes | str = work(job)
        except LegpushError as error:
            answer = str(error)
        pipe.send(answer)
