"""The kept results of soaks: several folders become one, and a folder without results is refused."""

from pathlib import Path

import pytest

from benchmarks.soak import kept, together
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

    found = kept(together([table, stepped]))

    assert list(found["made"]) == ["soak", "soak_2"]
    assert found["summary"]["all"]["n_same"] == 1
    assert found["steps"][0]["n_steps"] == 1000
    assert found["cells"]["kill-sim-walking, seed 0"] == "00000000 in 5 s"
    assert found["cells"]["drop-sim-walking, seed 0"]["same"] is False


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"with soak\.json in it"):
        together([tmp_path])
