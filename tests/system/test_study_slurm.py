"""Studies on a real Slurm of one node: jobs are cancelled, started again, and left behind by a head that is killed.

Needs Debian's packages `slurm-wlm` and `munge`, and root.
"""

import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

import pytest

from tests.system.slurm_node import has_slurm, slurm_node
from tests.system.studies import begun, require_each_cell_once, rows_of, start_study, write_study

pytestmark = pytest.mark.skipif(not has_slurm(), reason="needs Slurm, munge and root")

N_CELLS = 40
OPTIONS = ("--on", "slurm", "--workers", "3", "--slurm-option", "time=5")


@pytest.fixture(scope="module")
def slurm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    with slurm_node(tmp_path_factory.mktemp("slurm")) as environment:
        yield environment


def running(environment: dict[str, str]) -> list[str]:
    """The jobs that run now."""
    command = ["squeue", "--me", "--noheader", "--states=RUNNING", "--format=%i"]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.split()


def wait_until_begun(folder: Path, n_cells: int, environment: dict[str, str]) -> list[str]:
    """Wait until this many cells were begun, and return the jobs that run then."""
    deadline_s = monotonic() + 90.0
    while len(set(begun(folder))) < n_cells or not running(environment):
        assert monotonic() < deadline_s
        sleep(0.1)
    return running(environment)


def test_a_job_that_is_cancelled_and_one_that_is_requeued_lose_and_double_no_cell(
    slurm: dict[str, str], tmp_path: Path
) -> None:
    write_study(tmp_path, n_cells=N_CELLS, seconds=0.8)
    head = start_study(tmp_path, *OPTIONS, environment=slurm)
    jobs = wait_until_begun(tmp_path, 12, slurm)
    subprocess.run(["scancel", jobs[0]], env=slurm, check=True)
    subprocess.run(["scontrol", "requeue", jobs[-1]], env=slurm, check=True)
    output, _ = head.communicate(timeout=240)

    assert head.returncode == 0, output
    assert f"Job {jobs[0]} of Slurm is gone" in output
    assert len(begun(tmp_path)) > N_CELLS, "no cell was interrupted"
    require_each_cell_once(tmp_path, N_CELLS)
    assert len({row["host"] for row in rows_of(tmp_path)}) == 1


def test_what_jobs_do_while_the_head_is_away_counts(slurm: dict[str, str], tmp_path: Path) -> None:
    write_study(tmp_path, n_cells=N_CELLS, seconds=0.4)
    head = start_study(tmp_path, *OPTIONS, environment=slurm)
    wait_until_begun(tmp_path, 10, slurm)
    head.send_signal(signal.SIGKILL)
    head.wait()
    while running(slurm):
        sleep(0.2)
    n_begun = len(begun(tmp_path))
    assert not (tmp_path / "study" / "cells.parquet").exists()

    head = start_study(tmp_path, *OPTIONS, environment=slurm)
    output, _ = head.communicate(timeout=240)

    assert head.returncode == 0, output
    require_each_cell_once(tmp_path, N_CELLS)
    n_kept = N_CELLS - (len(begun(tmp_path)) - n_begun)
    assert n_kept > 10


def test_jobs_that_a_killed_head_left_behind_are_cancelled_by_the_next_one(
    slurm: dict[str, str], tmp_path: Path
) -> None:
    write_study(tmp_path, n_cells=12, seconds=3.0)
    head = start_study(tmp_path, *OPTIONS, environment=slurm)
    left = wait_until_begun(tmp_path, 6, slurm)
    head.send_signal(signal.SIGKILL)
    head.wait()

    head = start_study(tmp_path, *OPTIONS, environment=slurm)
    deadline_s = monotonic() + 60.0
    while set(left) & set(running(slurm)):
        assert monotonic() < deadline_s
        sleep(0.1)
    output, _ = head.communicate(timeout=240)

    assert head.returncode == 0, output
    require_each_cell_once(tmp_path, 12)


def test_ctrl_c_cancels_the_jobs_and_keeps_what_is_done(slurm: dict[str, str], tmp_path: Path) -> None:
    write_study(tmp_path, n_cells=N_CELLS, seconds=0.5)
    head = start_study(tmp_path, *OPTIONS, environment=slurm)
    wait_until_begun(tmp_path, 8, slurm)
    head.send_signal(signal.SIGINT)
    output, _ = head.communicate(timeout=60)

    assert head.returncode == 130, output
    deadline_s = monotonic() + 20.0
    while running(slurm):
        assert monotonic() < deadline_s
        sleep(0.2)


def test_an_option_that_slurm_refuses_ends_the_study_before_a_cell_runs(slurm: dict[str, str], tmp_path: Path) -> None:
    write_study(tmp_path, n_cells=3, seconds=0.0)
    head = start_study(tmp_path, *OPTIONS, "--slurm-option", "partition=nowhere", environment=slurm)
    output, _ = head.communicate(timeout=60)

    assert head.returncode == 2, output
    assert "nowhere" in output or "partition" in output
    assert begun(tmp_path) == []
