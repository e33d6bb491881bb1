"""The kept results of soaks: several folders become one, and a folder without results is refused."""

from pathlib import Path

import pytest

from benchmarks.soak import found_in, with_before
from legpush.errors import ConfigError
from legpush.soak.results import read_results, write_results
from tests.legpush.soak.test_results import cell, steps


def test_folders_are_put_together_and_a_cell_that_went_wrong_is_kept_in_full(tmp_path: Path) -> None:
    table, stepped = tmp_path / "table", tmp_path / "steps"
    for folder in (table, stepped):
        folder.mkdir()
    results = read_results(table)
    results.cells = [cell("kill-sim-walking", resumed_s=0.5), cell("drop-sim-walking", same=False)]
    write_results(table, results)
    results = read_results(stepped)
    results.steps = [steps(0.001)]
    write_results(stepped, results)

    found = found_in([table, stepped])

    assert list(found["made"]) == ["soak", "soak_steps"]
    assert found["summary"]["all"]["n_same"] == 1
    assert found["steps"][0]["n_steps"] == 1000
    assert found["cells"]["kill-sim-walking, seed 0"] == "00000000 in 5 s"
    assert found["cells"]["drop-sim-walking, seed 0"]["same"] is False


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"with soak\.json in it"):
        found_in([tmp_path])


def test_a_part_that_is_not_done_again_stays_as_it_was_with_how_it_was_made() -> None:
    before = {"made": {"soak": {"commit": "a"}, "soak_steps": {"commit": "a"}}, "cells": {"x": "y"}, "steps": [1]}
    before |= {"summary": {"all": 1}, "kills": {}}
    found = {"made": {"soak_steps": {"commit": "b"}}, "steps": [2]}
    now = with_before(found, before)
    assert now["made"] == {"soak": {"commit": "a"}, "soak_steps": {"commit": "b"}}
    assert (now["steps"], now["cells"], now["summary"]) == ([2], {"x": "y"}, {"all": 1})
    assert "training" not in now
