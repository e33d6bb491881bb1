import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest

from legpush.errors import LegpushError
from legpush.study.engines.engine import WorkerLostError
from legpush.study.engines.local import LocalEngine
from legpush.study.jobs import Answer, Job, decode_answer, encode

from ..parts import STUB, study_of

HEAD = """
import sys
from legpush.study.engines.local import LocalEngine
if __name__ == "__main__":
    engine = LocalEngine(1)
    future = engine.submit(bytes.fromhex(sys.argv[1]))
    while not engine._workers:
        pass
    print(next(iter(engine._workers))._process.pid, flush=True)
    future.result()
"""


def job_of(*seeds: int, seconds: float = 0.0, kill_at: int = -1, kind: str = STUB) -> bytes:
    study = study_of(f"[settings]\nseconds = {seconds}\nkill_at = {kill_at}\n[axes]\nseed = {list(seeds)}\n")
    return encode(Job(kind=kind, code=study.code, canary=None, results=None, tasks=tuple(study.tasks())))


def values(payload: bytes) -> list[float]:
    return [row.columns["value"] for row in decode_answer(payload).rows]


def eventually(holds: Callable[[], bool]) -> bool:
    end_s = time.monotonic() + 20.0
    while time.monotonic() < end_s:
        if holds():
            return True
        time.sleep(0.05)
    return holds()


def test_jobs_run_side_by_side_in_processes_of_their_own() -> None:
    engine = LocalEngine(2)
    answers: list[Answer] = [decode_answer(f.result()) for f in [engine.submit(job_of(n, seconds=1.0)) for n in (1, 2)]]
    engine.close(now=False)
    assert engine.n_slots() == 2
    assert [answer.rows[0].columns["value"] for answer in answers] == [1.0, 2.0]
    assert len({answer.pid for answer in answers} | {os.getpid()}) == 3
    assert not any(psutil.pid_exists(answer.pid) for answer in answers)


def test_a_worker_that_ends_costs_its_present_job_only() -> None:
    engine = LocalEngine(1)
    lost, after = engine.submit(job_of(1, 2, kill_at=2)), engine.submit(job_of(3))
    with pytest.raises(WorkerLostError, match=r"Worker \d+ on this machine ended with exit code 7"):
        lost.result()
    assert values(after.result()) == [3.0]
    engine.close(now=False)


def test_a_worker_that_is_killed_is_named_with_the_signal() -> None:
    engine = LocalEngine(1)
    pid = decode_answer(engine.submit(job_of(1)).result()).pid
    running = engine.submit(job_of(1, seconds=60.0))
    os.kill(pid, signal.SIGKILL)
    with pytest.raises(WorkerLostError, match=f"Worker {pid} on this machine ended with SIGKILL"):
        running.result()
    engine.close(now=False)


def test_closing_now_ends_workers_in_the_middle_of_their_cells() -> None:
    engine = LocalEngine(1)
    pid = decode_answer(engine.submit(job_of(1)).result()).pid
    running, waiting = engine.submit(job_of(1, seconds=60.0)), engine.submit(job_of(2))
    assert eventually(running.running)
    engine.close(now=True)
    assert isinstance(running.exception(), WorkerLostError)
    assert waiting.cancelled()
    assert not psutil.pid_exists(pid)


def test_an_error_of_the_worker_reaches_the_head() -> None:
    engine = LocalEngine(1)
    with pytest.raises(LegpushError, match=r"Expected a kind of cell .* got 'no_such_kind'"):
        engine.submit(job_of(1, kind="no_such_kind")).result()
    assert values(engine.submit(job_of(5)).result()) == [5.0]
    engine.close(now=False)


def test_no_worker_outlives_its_head(tmp_path: Path) -> None:
    (tmp_path / "head.py").write_text(HEAD)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path.cwd()), *filter(None, sys.path)])}
    command = [sys.executable, str(tmp_path / "head.py"), job_of(1, seconds=60.0).hex()]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as head:
        assert head.stdout is not None
        pid = int(head.stdout.readline())
        head.kill()
    assert eventually(lambda: not psutil.pid_exists(pid))
