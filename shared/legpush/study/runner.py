"""Runs the missing cells of a study on an engine, and keeps their rows."""

import logging
import threading
from collections import Counter, deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any, Final

from msgspec.structs import replace

from legpush.errors import LegpushError
from legpush.study.engines.engine import Engine, WorkerLostError
from legpush.study.folder import FailedCell, StudyFolder
from legpush.study.jobs import Answer, Job, Task, decode_answer, encode
from legpush.study.rows import write_part

log = logging.getLogger(__name__)

MOST_ROWS: Final = 256
"""Most rows that wait to be written."""
FLUSH_S: Final = 1.0
"""Longest time that a row waits to be written."""
TURN_S: Final = 0.2
"""How often to look for a request to stop while no job ends."""
MOST_LOSSES: Final = 3
"""A cell whose worker was lost this many times has failed. The last time it is sent alone."""
REFUSALS_PER_SLOT: Final = 3
"""Give up after this many refusals in a row for each slot."""


class EngineError(LegpushError):
    """An engine without a worker that can run the study."""


@dataclass
class Tally:
    """How far a study is."""

    n_cells: int
    n_done: int
    """Cells with a row."""
    n_failed: int = 0
    n_retried: int = 0
    """Cells that were sent again because their worker was lost."""
    n_new: int = 0
    """Cells that ended since the program began, with a row or not."""
    refused: set[str] = field(default_factory=set)
    """Workers that refused, with their reasons."""


class Runner:
    """Sends cells to an engine until none is missing."""

    def __init__(
        self,
        engine: Engine,
        folder: StudyFolder,
        *,
        job: Job,
        task: Callable[[int], Task],
        missing: Sequence[int],
        tally: Tally,
        stop: threading.Event,
        on_turn: Callable[[Tally], None] = lambda _: None,
        on_canary: Callable[[str], None] = lambda _: None,
    ) -> None:
        """`job` has what all jobs share; `task` makes a cell by its index; `missing` has the indices of those to run.

        `on_canary` gets the canary of the first worker, if `job` has none.
        """
        self._engine = engine
        self._folder = folder
        self._job = job
        self._task = task
        self._waiting = deque(missing)
        self._alone: deque[int] = deque()
        self._running: dict[Future[bytes], dict[str, tuple[int, Task]]] = {}
        # Waiting for futures takes longer the more there are; a queue does not.
        self._done: SimpleQueue[Future[bytes]] = SimpleQueue()
        self._losses: Counter[int] = Counter()
        self._rows: list[dict[str, Any]] = []
        self._oldest_s = 0.0
        self._cell_s: float | None = None
        """Recent mean time of a cell."""
        self._n_refusals = 0
        self._most_slots = 0
        self._tally = tally
        self._stop = stop
        self._on_turn = on_turn
        self._on_canary = on_canary

    def run(self) -> None:
        """Run all missing cells, or until asked to stop; finished rows are written in every case.

        Raises:
            DiskError: Rows cannot be written; those before are kept.
            EngineError: No worker computes what the study expects.
            LegpushError: The engine failed.
        """
        ended = False
        try:
            while not self._stop.is_set() and (self._waiting or self._alone or self._running):
                self._send()
                for future in self._ended():
                    self._take(future, self._running.pop(future))
                self._flush()
                self._on_turn(self._tally)
            ended = not self._stop.is_set()
        finally:
            try:
                self._engine.close(now=not ended)
            finally:
                self._flush(now=True)

    def _send(self) -> None:
        """Keep every slot busy."""
        n_slots = self._engine.n_slots()
        self._most_slots = max(self._most_slots, n_slots)
        while len(self._running) < self._engine.pace.jobs_per_slot * n_slots:
            indices = self._next(n_slots)
            if not indices:
                return
            sent = {(task := self._task(index)).cell: (index, task) for index in indices}
            job = replace(self._job, tasks=tuple(task for _, task in sent.values()))
            future = self._engine.submit(encode(job))
            self._running[future] = sent
            future.add_done_callback(self._done.put)

    def _ended(self) -> list["Future[bytes]"]:
        """Return the jobs that have ended, after a short wait for the first one."""
        try:
            ended = [self._done.get(timeout=TURN_S)]
        except Empty:
            return []
        while not self._done.empty():
            ended.append(self._done.get())
        return ended

    def _next(self, n_slots: int) -> list[int]:
        """Return the cells of the next job; empty if there is nothing to send now."""
        if self._alone:
            return [self._alone.popleft()]
        if self._cell_s is None:
            # The first answers say how long a cell takes.
            n = 1 if len(self._running) < n_slots else 0
        else:
            pace = self._engine.pace
            fair = -(-len(self._waiting) // (pace.jobs_per_slot * n_slots))
            n = max(1, min(round(pace.batch_s / max(self._cell_s, 1e-6)), pace.most_cells, fair))
        return [self._waiting.popleft() for _ in range(min(n, len(self._waiting)))]

    def _take(self, future: "Future[bytes]", sent: dict[str, tuple[int, Task]]) -> None:
        """Take the answer to a job, or send its cells again."""
        try:
            answer = decode_answer(future.result())
        except WorkerLostError as error:
            self._lose(sent, str(error))
            return
        if answer.refused is None and self._job.canary is None and answer.canary is not None:
            self._job = replace(self._job, canary=answer.canary)
            self._on_canary(answer.canary)
        refused = answer.refused or self._other_canary(answer)
        if refused is not None:
            self._refuse(sent, answer, refused)
            return
        self._n_refusals = 0
        for row in answer.rows:
            if not self._engine.workers_keep_rows:
                self._oldest_s = self._oldest_s if self._rows else monotonic()
                self._rows.append(row.columns)
            self._cell_s = row.wall_s if self._cell_s is None else 0.8 * self._cell_s + 0.2 * row.wall_s
            self._tally.n_done += 1
        for failure in answer.failures:
            task = sent[failure.cell][1]
            self._fail(task, own=True, error=failure.error, traceback=failure.traceback, host=answer.host)
        self._tally.n_new += len(answer.rows)
        if self._cell_s is None and answer.failures:
            self._cell_s = self._engine.pace.batch_s

    def _other_canary(self, answer: Answer) -> str | None:
        """Return why an answer cannot count that was begun before the canary of the study was known."""
        if self._job.canary in (None, answer.canary):
            return None
        return f"expected the canary {self._job.canary}, computes {answer.canary} (numerics {answer.numerics})"

    def _refuse(self, sent: dict[str, tuple[int, Task]], answer: Answer, why: str) -> None:
        """Send the cells of a worker that refused to another one."""
        text = f"{answer.host}: {why}"
        if text not in self._tally.refused:
            log.warning("refused a worker on %s", text)
            self._tally.refused.add(text)
        self._waiting.extendleft(index for index, _ in sent.values())
        self._n_refusals += 1
        # An engine has fewer slots when it keeps cells from a node that refused; some may have been sent there before.
        if self._engine.n_slots() == 0 or self._n_refusals > REFUSALS_PER_SLOT * self._most_slots:
            raise EngineError(f"No worker can run this study: {'; '.join(sorted(self._tally.refused))}")

    def _lose(self, sent: dict[str, tuple[int, Task]], why: str) -> None:
        log.warning("%s; its %d cells are sent again", why, len(sent))
        for index, task in sent.values():
            self._losses[index] += 1
            if self._losses[index] >= MOST_LOSSES:
                self._fail(task, own=False, error=f"{why}, {MOST_LOSSES} times")
                continue
            self._tally.n_retried += 1
            (self._alone if self._losses[index] == MOST_LOSSES - 1 else self._waiting).append(index)

    def _fail(self, task: Task, *, own: bool, error: str, traceback: str = "", host: str = "") -> None:
        self._folder.keep_failure(
            FailedCell(cell=task.cell, inputs=task.inputs, own=own, error=error, traceback=traceback, host=host)
        )
        self._tally.n_failed += 1
        self._tally.n_new += 1

    def _flush(self, *, now: bool = False) -> None:
        """Write the rows that wait, if it is time to."""
        if self._rows and (now or len(self._rows) >= MOST_ROWS or monotonic() - self._oldest_s >= FLUSH_S):
            rows, self._rows = self._rows, []
            write_part(self._folder.parts, rows)
