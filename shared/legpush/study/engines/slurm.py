"""Runs jobs on a Slurm cluster, each as a job of Slurm, through submitit.

A worker writes its rows into the folder of the study by itself. So what it does while the head of the study is away
counts, and a job that Slurm starts again goes on where its last part ends.
"""

import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import threading
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep
from typing import Any, Final

import submitit
from submitit.core.utils import FailedJobError, UncompletedJobError
from submitit.slurm.slurm import SlurmExecutor

from legpush.errors import ConfigError, LegpushError
from legpush.files import make_folder
from legpush.study.engines.engine import Pace, WorkerLostError
from legpush.study.engines.kept_work import work_and_keep
from legpush.study.folder import PARTS
from legpush.study.jobs import decode_answer

FOLDER: Final = "slurm"
"""Scripts and logs of the jobs, in the folder of the study."""
LOCAL: Final = "local"
"""The cluster that is no Slurm: submitit's own processes on this machine."""
DEFAULTS: Final[dict[str, Any]] = {"time": 60, "cpus_per_task": 1}
"""Minutes and CPUs of a job, if the user says nothing else."""
NOT_OPTIONS: Final = frozenset(
    {"additional_parameters", "job_name", "map_count", "nodes", "ntasks_per_node", "setup", "srun_args", "teardown"}
)
"""Parameters of submitit that are ours to set, or that are no text or number."""
POLL_S: Final = 0.5
"""How often to look for results."""
QUEUE_S: Final = 5.0
"""How often to ask Slurm which jobs it still has."""
GRACE_S: Final = 20.0
"""A job that Slurm no longer has is lost after this time without a result: a shared disk may show files late."""
COMMAND_S: Final = 60.0
"""Longest time that a command of Slurm may take."""


class SlurmWork:
    """What a job of Slurm does; submitit asks it for a checkpoint before Slurm ends it."""

    def __call__(self, parts: Path, payload: bytes) -> tuple[str, bytes]:
        """Return the name of the node and the answer to the job."""
        again = int(os.environ.get("SLURM_RESTART_COUNT", "0")) > 0
        return os.environ.get("SLURMD_NODENAME", platform.node()), work_and_keep(parts, payload, again=again)

    def checkpoint(self, parts: Path, payload: bytes) -> submitit.helpers.DelayedSubmission:
        """Have the job put back into the queue when its time is over or another one needs the node."""
        return submitit.helpers.DelayedSubmission(self, parts, payload)


@dataclass
class _Pending:
    """A job that has no result yet."""

    job: submitit.Job[tuple[str, bytes]]
    answer: Future[bytes]
    missing_since_s: float | None = None
    """When Slurm did not have it any more."""


class SlurmEngine:
    """Jobs as jobs of Slurm; Slurm decides when and where each one runs, and starts them again if a node fails.

    A node whose worker refuses a job gets no other one.
    """

    name = "slurm"
    pace = Pace(batch_s=300.0, most_cells=10_000, jobs_per_slot=1)
    workers_keep_rows = True

    def __init__(self, study: Path, *, n_jobs: int, options: Mapping[str, str], environment: Mapping[str, str]) -> None:
        """Check the options, and cancel jobs that an earlier head of this study left in the queue.

        Args:
            study: Folder of the study, which all nodes see under the same path.
            n_jobs: Most jobs that are in the queue at the same time.
            options: Options of `sbatch`, such as `partition`, by name; `cluster=local` needs no Slurm.
            environment: Environment variables of the workers.

        Raises:
            ConfigError: This machine has no Slurm, or an option cannot be used.
        """
        self._n_jobs = n_jobs
        self._parts = study.absolute() / PARTS
        self._name = f"legpush-{hashlib.sha256(str(study.absolute()).encode()).hexdigest()[:8]}"
        self._is_local, self._parameters = _read_options(options)
        folder = study.absolute() / FOLDER
        make_folder(folder, private=True)  # the scripts in it hold environment variables of the user
        if self._is_local:
            # A setup would put a shell between submitit and the worker, which ends the one without the other.
            os.environ.update(environment)
            self._executor: Any = submitit.LocalExecutor(folder)
            self._executor.update_parameters(timeout_min=self._parameters["time"])
        else:
            setup = [f"export {name}={shlex.quote(value)}" for name, value in environment.items()]
            _require_slurm()
            self._executor = SlurmExecutor(folder)
            self._executor.update_parameters(job_name=self._name, setup=setup, **self._parameters)
            _cancel_all(self._name)
        self._refused_nodes: set[str] = set()
        self._lock = threading.Lock()
        self._pending: list[_Pending] = []
        self._queue: frozenset[str] = frozenset()
        self._queue_s = float("-inf")
        self._end = threading.Event()
        self._watcher = threading.Thread(target=self._watch, name="slurm", daemon=True)
        self._watcher.start()

    def n_slots(self) -> int:
        """Return how many jobs may be in the queue at the same time."""
        return self._n_jobs

    def submit(self, job: bytes) -> "Future[bytes]":
        """Queue a job; see `Engine`.

        Raises:
            ConfigError: Slurm does not take the job.
        """
        answer: Future[bytes] = Future()
        try:
            submitted = self._executor.submit(SlurmWork(), self._parts, job)
        except (FailedJobError, subprocess.CalledProcessError, OSError) as error:
            raise ConfigError(f"Slurm takes no job of this study: {_last_line(str(error))}") from error
        with self._lock:
            self._pending.append(_Pending(submitted, answer))
        return answer

    def close(self, *, now: bool) -> None:
        """End the jobs: `now`, or when those that are queued are done."""
        if now:
            with self._lock:
                pending = tuple(self._pending)
            for each in pending:
                each.job.cancel(check=False)
        else:
            while self._pending and not self._end.wait(POLL_S):
                pass
        self._end.set()
        self._watcher.join()

    def _watch(self) -> None:
        """Pass on results and losses until the engine is closed."""
        while not self._end.wait(POLL_S):
            with self._lock:
                pending = tuple(self._pending)
            for each in pending:
                if self._take(each):
                    with self._lock:
                        self._pending.remove(each)

    def _take(self, pending: _Pending) -> bool:
        """Pass on the result of a job, or its loss; False if it has neither yet."""
        if pending.job.paths.result_pickle.exists():
            self._take_result(pending)
        elif self._is_alive(pending.job):
            pending.missing_since_s = None
            return False
        elif pending.missing_since_s is None:
            pending.missing_since_s = monotonic()
            return False
        elif monotonic() - pending.missing_since_s < (POLL_S if self._is_local else GRACE_S):
            return False
        else:
            log = pending.job.paths.stderr
            words = _last_line(log.read_text(errors="replace")) if log.exists() else "it wrote no log"
            pending.answer.set_exception(WorkerLostError(f"Job {pending.job.job_id} of Slurm is gone ({words})"))
        return True

    def _take_result(self, pending: _Pending) -> None:
        try:
            node, payload = pending.job.result()
        except UncompletedJobError as error:
            words = _cause(str(error))
            lost = UncompletedJobError.__name__ in words
            pending.answer.set_exception(WorkerLostError(words) if lost else LegpushError(words))
            return
        except (OSError, EOFError) as error:
            pending.answer.set_exception(WorkerLostError(f"The result of job {pending.job.job_id} is lost ({error})"))
            return
        if decode_answer(payload).refused is not None and not self._is_local:
            self._refused_nodes.add(node)
            self._executor.update_parameters(exclude=",".join(sorted(self._refused_nodes)))
        pending.answer.set_result(payload)

    def _is_alive(self, job: submitit.Job[tuple[str, bytes]]) -> bool:
        """Return whether a job waits or runs."""
        if self._is_local:
            return not job.done()
        if monotonic() - self._queue_s >= QUEUE_S:
            queue = _queued(self._name)
            if queue is None:
                return True
            self._queue, self._queue_s = queue, monotonic()
        return job.job_id in self._queue


def _read_options(options: Mapping[str, str]) -> tuple[bool, dict[str, Any]]:
    """Return whether no Slurm is needed, and the parameters of submitit.

    Raises:
        ConfigError: An option is unknown; names the valid ones.
    """
    valid = {*(SlurmExecutor._valid_parameters() - NOT_OPTIONS), "cluster"}
    if unknown := sorted(options.keys() - valid):
        raise ConfigError(f"Expected an option of Slurm ({', '.join(sorted(valid))}), got {', '.join(unknown)}")
    cluster = options.get("cluster", "slurm")
    if cluster not in ("slurm", LOCAL):
        raise ConfigError(f"Expected slurm or {LOCAL} for the cluster, got {cluster!r}")
    given = {name: int(value) if value.isdecimal() else value for name, value in options.items() if name != "cluster"}
    parameters = {**DEFAULTS, **given}
    if not isinstance(parameters["time"], int):
        raise ConfigError(f"Expected minutes for the time of a job, got {parameters['time']!r}")
    return cluster == LOCAL, parameters


def _require_slurm() -> None:
    missing = [command for command in ("sbatch", "srun", "squeue", "scancel") if shutil.which(command) is None]
    if missing:
        raise ConfigError(
            f"--on slurm needs the commands of Slurm, and this machine has no {', '.join(missing)}; start the study "
            "where you would call sbatch"
        )


def _queued(name: str) -> frozenset[str] | None:
    """Return the jobs with a name that wait or run; None if Slurm does not answer."""
    command = ["squeue", "--me", "--noheader", "--format=%i", f"--name={name}"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=COMMAND_S, check=True)
    except (subprocess.SubprocessError, OSError):
        return None
    return frozenset(done.stdout.split())


def _cancel_all(name: str) -> None:
    """Cancel the jobs with a name, and wait until none is left."""
    left = _queued(name)
    if left is None:
        raise ConfigError("Expected a Slurm that answers squeue, got none")
    deadline_s = monotonic() + COMMAND_S
    while left and monotonic() < deadline_s:
        command = ["scancel", *sorted(left)]
        subprocess.run(command, capture_output=True, timeout=COMMAND_S, check=False)
        sleep(POLL_S)
        left = _queued(name)


def _cause(text: str) -> str:
    """Return the last line of the traceback in what submitit says of a failed job."""
    trace = text.split("----------------------")
    return _last_line(trace[1] if len(trace) > 1 else text)


def _last_line(text: str) -> str:
    lines = [line for line in text.splitlines() if line.strip()]
    return lines[-1].strip() if lines else ""
