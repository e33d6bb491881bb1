"""Jobs of Slurm, run by submitit on this machine; a real Slurm is in `system/test_study_slurm.py`."""

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

import pytest

from legpush.errors import ConfigError, LegpushError
from legpush.study.engines.engine import WorkerLostError
from legpush.study.engines.slurm import SlurmEngine, SlurmWork
from legpush.study.identity import code_version
from legpush.study.jobs import Job, Task, decode_answer, encode
from legpush.study.rows import cells_in

KIND = "tests.legpush.study.stub:STUB"


def job(*, kind: str = KIND, seed: int = 3, kill_at: int = -1, seconds: float = 0.0) -> bytes:
    """A job of one cell."""
    specification = {"seed": seed, "kill_at": kill_at, "seconds": seconds}
    task = Task(cell=f"{seed:032x}", inputs={"seed": seed}, specification=specification)
    return encode(Job(kind=kind, code=code_version(KIND), canary=None, results=None, tasks=(task,)))


@pytest.fixture
def engine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[SlurmEngine]:
    monkeypatch.setenv("LEGPUSH_TEST", "0")
    (tmp_path / "parts").mkdir()
    engine = SlurmEngine(tmp_path, n_jobs=2, options={"cluster": "local"}, environment={"LEGPUSH_TEST": "1 2"})
    yield engine
    engine.close(now=True)


def test_a_job_is_answered_and_its_row_lies_in_the_study(engine: SlurmEngine, tmp_path: Path) -> None:
    answer = decode_answer(engine.submit(job()).result(timeout=60))
    (row,) = answer.rows
    assert row.columns["value"] == 3.0
    assert answer.pid != os.getpid()
    assert cells_in((tmp_path / "parts").iterdir()) == {row.cell}


def test_a_worker_that_dies_costs_its_job_only(engine: SlurmEngine) -> None:
    lost, other = engine.submit(job(kill_at=3)), engine.submit(job(seed=4, kill_at=3))
    with pytest.raises(WorkerLostError, match=r"Job \d+ of Slurm is gone"):
        lost.result(timeout=60)
    assert decode_answer(other.result(timeout=60)).rows


def test_an_error_of_a_worker_is_told(engine: SlurmEngine) -> None:
    with pytest.raises(LegpushError, match="nowhere"):
        engine.submit(job(kind="nowhere")).result(timeout=60)


def test_workers_have_the_environment_that_was_given(engine: SlurmEngine) -> None:
    del engine
    assert os.environ["LEGPUSH_TEST"] == "1 2"


def test_closing_at_once_ends_what_runs(engine: SlurmEngine, tmp_path: Path) -> None:
    engine.submit(job(seconds=600.0))
    log = tmp_path / "slurm"
    deadline_s = monotonic() + 240.0
    while not any("Loading pickle" in path.read_text() for path in log.glob("*.out")):
        assert monotonic() < deadline_s
        sleep(0.1)
    engine.close(now=True)
    while subprocess.run(["pgrep", "-f", f"_submit {log}"], check=False, capture_output=True).stdout:
        assert monotonic() < deadline_s
        sleep(0.1)


def test_a_job_whose_time_is_over_goes_back_into_the_queue(tmp_path: Path) -> None:
    again = SlurmWork().checkpoint(tmp_path, b"job")
    assert isinstance(again.function, SlurmWork)
    assert again.args == (tmp_path, b"job")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"partitions": "cpu"}, r"Expected an option of Slurm \(account, .*partition, .*time.*\), got partitions"),
        ({"setup": "rm"}, "got setup"),
        ({"cluster": "other"}, "Expected slurm or local for the cluster"),
        ({"cluster": "local", "time": "1:00"}, "Expected minutes"),
    ],
)
def test_options_that_cannot_be_used_are_named(options: dict[str, str], said: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=said):
        SlurmEngine(tmp_path, n_jobs=1, options=options, environment={})


def test_a_machine_without_slurm_is_told_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)
    with pytest.raises(ConfigError, match="no sbatch, srun, squeue, scancel"):
        SlurmEngine(tmp_path, n_jobs=1, options={}, environment={})
