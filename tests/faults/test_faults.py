"""Whole missions with a fault: each ends as if nothing had happened, or with the one error that the table wants.

Ten cells of the table are always run, and five more are drawn by the commit. LEGPUSH_FAULT_SEED draws others, and
LEGPUSH_FAULT_CELLS, such as `kill-sim-walking corrupt`, names those to run. `legpush bench soak` runs the whole table.
"""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from legpush.soak.cell_run import run_cell, undisturbed
from legpush.soak.table import Cell, choose_cells
from tests.system.missions import once

SEED = 0
FIXED = (
    "kill-planner-planning",
    "kill-sim-walking",
    "kill-agent-pushing",
    "terminate-agent-walking",
    "freeze_long-sim-pushing",
    "cut-agent-walking",
    "corrupt-planner-planning",
    "drop-sim-pushing",
    "disk_full-agent-pushing",
    "clock_back-agent-walking",
)
N_DRAWN = 5


def draw_seed() -> int:
    """The seed of the drawn cells: the same for all processes of a test run."""
    given = os.environ.get("LEGPUSH_FAULT_SEED")
    if given is not None:
        return int(given)
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return int(done.stdout[:8], 16) if done.returncode == 0 else 0


def chosen() -> list[Cell]:
    """The cells of this test run."""
    if names := os.environ.get("LEGPUSH_FAULT_CELLS", "").split():
        return list(choose_cells(tuple(names)))
    others = [cell for cell in choose_cells(()) if cell.name not in FIXED]
    drawn = np.random.default_rng(draw_seed()).choice(len(others), N_DRAWN, replace=False)
    return [*choose_cells(FIXED), *(others[index] for index in sorted(drawn))]


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Path:
    """The folder of the undisturbed mission."""
    own = tmp_path_factory.getbasetemp()
    shared = own if worker_id == "master" else own.parent
    folder = once(shared / "undisturbed-by-faults", lambda folder: assert_made(undisturbed(folder, SEED)))
    return undisturbed(folder, SEED)


def assert_made(out: Path) -> None:
    assert (out / "report.json").exists()


@pytest.mark.parametrize("cell", chosen(), ids=lambda cell: cell.name)
def test_a_mission_with_a_fault_ends_as_the_table_says(cell: Cell, expected: Path, tmp_path: Path) -> None:
    result = run_cell(cell, tmp_path / "cell", expected, SEED)
    assert result.is_as_expected, f"LEGPUSH_FAULT_SEED={draw_seed()} LEGPUSH_FAULT_CELLS={cell.name}: {result}"
