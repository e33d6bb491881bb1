"""What tests of studies share: a study of stub cells, and engines that do what a test says."""

from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path

from legpush.study.carry_out import study_record
from legpush.study.engines.engine import Pace, WorkerLostError
from legpush.study.file import Study, read_study
from legpush.study.folder import StudyFolder
from legpush.study.jobs import Answer, Job, decode_job, encode
from legpush.study.work import work

STUB = "tests.legpush.study.stub:STUB"


def study_of(text: str = "[axes]\nseed = { first = 0, n = 6 }\n") -> Study:
    """A study of stub cells."""
    return read_study(f'name = "stub"\n{text}', "study.toml", own_cell=STUB)


def begun(path: Path, study: Study) -> StudyFolder:
    """A folder in which a study has begun."""
    folder = StudyFolder(path)
    with folder.opened(
        (study.source,), study_record(study, [task.cell for task in study.tasks()], "legpush study run")
    ):
        return folder


class FakeEngine:
    """Answers jobs at once, in this process, as `answer` says; by default as a worker would."""

    name = "fake"
    pace = Pace()
    workers_keep_rows = False

    def __init__(self, answer: Callable[[Job], Answer | None] | None = None) -> None:
        """`answer` returns None for a worker that is lost."""
        self.jobs: list[Job] = []
        self.closed_now: bool | None = None
        self._answer = answer

    def n_slots(self) -> int:
        """Two workers."""
        return 2

    def submit(self, job: bytes) -> "Future[bytes]":
        """Answer a job."""
        self.jobs.append(decode_job(job))
        future: Future[bytes] = Future()
        answer = self._answer(self.jobs[-1]) if self._answer is not None else None
        if self._answer is None:
            future.set_result(work(job))
        elif answer is None:
            future.set_exception(WorkerLostError("Worker 1 on this machine ended with SIGKILL"))
        else:
            future.set_result(encode(answer))
        return future

    def close(self, *, now: bool) -> None:
        """Note how it was closed."""
        self.closed_now = now
