"""`legpush bench soak` as a command: it goes on in its folder, and says what cannot be done."""

import json
import threading
from pathlib import Path

import pytest
from rich.console import Console

from legpush.errors import ConfigError, PeerError
from legpush.options.bench import SoakOptions
from legpush.soak import run
from legpush.soak.cell_run import CellResult
from legpush.soak.results import RESULTS_FILE
from legpush.soak.run import run_soak
from legpush.soak.table import Cell
from tests.legpush.soak.test_results import cell as result_of

CELLS = ("kill-sim-walking", "drop-sim-walking", "cut-sim-walking")


@pytest.fixture
def done(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, int]]:
    """The cells that were run, with their seeds; a stand-in runs them."""
    ran: list[tuple[str, int]] = []

    def run_cell(cell: Cell, folder: Path, expected: Path, seed: int) -> CellResult:
        if len(ran) == 2:
            raise PeerError("the mission was never in its phase")
        ran.append((cell.name, seed))
        return result_of(cell.name, same=cell.kind != "drop")

    monkeypatch.setattr(run, "run_cell", run_cell)
    monkeypatch.setattr(run, "undisturbed", lambda folder, seed: folder)
    monkeypatch.setattr(run, "stop_on_signals", threading.Event)
    return ran


def test_what_is_done_is_kept_and_the_same_command_does_the_rest(tmp_path: Path, done: list[tuple[str, int]]) -> None:
    options = SoakOptions(out=tmp_path / "soak", cells=CELLS)
    with pytest.raises(PeerError):
        run_soak(options, Console(quiet=True))
    assert [name for name, _ in done] == list(CELLS[:2])
    done.clear()
    assert run_soak(options, Console(quiet=True)) == 1  # one of them is not as expected
    assert [name for name, _ in done] == list(CELLS[2:])
    kept = json.loads((tmp_path / "soak" / RESULTS_FILE).read_text())
    assert [cell["name"] for cell in kept["cells"]] == list(CELLS)
    assert kept["summary"]["all"] == {"n_cells": 3, "n_survived": 3, "n_same": 2, "n_as_expected": 2}


def test_cells_that_were_not_as_expected_are_run_again_on_demand(tmp_path: Path, done: list[tuple[str, int]]) -> None:
    assert run_soak(SoakOptions(out=tmp_path, cells=CELLS[:2]), Console(quiet=True)) == 1
    done.clear()
    assert run_soak(SoakOptions(out=tmp_path, cells=CELLS[:2]), Console(quiet=True)) == 1
    assert done == []
    assert run_soak(SoakOptions(out=tmp_path, cells=CELLS[:2], retry=True), Console(quiet=True)) == 1
    assert [name for name, _ in done] == [CELLS[1]]


def test_cells_are_repeated_with_the_next_seeds(tmp_path: Path, done: list[tuple[str, int]]) -> None:
    options = SoakOptions(out=tmp_path, cells=CELLS[:1], repeat=2, seed=7)
    assert run_soak(options, Console(quiet=True)) == 0
    assert done == [(CELLS[0], 7), (CELLS[0], 8)]


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path, done: list[tuple[str, int]]) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="Expected a folder that can be made for --out"):
        run_soak(SoakOptions(out=tmp_path / "file" / "soak", cells=CELLS), Console(quiet=True))
    assert done == []
