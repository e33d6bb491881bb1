"""Results: kept in a file that can be read again, summarized by kind, and right only if everything is."""

from pathlib import Path

import pytest

from legpush.soak.cell_run import CellResult
from legpush.soak.resources import Growth
from legpush.soak.results import SoakResults, read_results, table_lines, write_results
from legpush.soak.steps import StepsResult
from legpush.soak.timing import Times
from legpush.soak.training import TrainingResult


def cell(name: str, *, survived: bool = True, same: bool = True, resumed_s: float | None = None) -> CellResult:
    times = None
    if resumed_s is not None:
        times = Times(
            noticed_by_peers_s=0.005,
            noticed_by_launcher_s=0.01,
            spawn_s=0.003,
            imports_s=0.3,
            connect_s=0.1,
            redo_s=None,
            resumed_s=resumed_s,
        )
    return CellResult(
        name=name,
        seed=0,
        expected="same",
        survived=survived,
        same=same,
        state_crc="00000000",
        exit_codes=(0,),
        took_s=5.0,
        wrong=(),
        times=times,
    )


def steps(memory: float) -> StepsResult:
    growth = Growth(n_samples=100, memory_mb=80.0, memory=memory, threads=0, files=0)
    return StepsResult(n_steps=1000, steps_per_s=900.0, growth={"agent": growth, "sim": None})


def trained(*different: str) -> TrainingResult:
    return TrainingResult(
        hours=0.5,
        n_steps=1280,
        killed_simulators=60,
        killed_learners=10,
        same_files=(),
        different_files=different,
        growth=(),
    )


@pytest.fixture
def results(tmp_path: Path) -> SoakResults:
    found = read_results(tmp_path)
    found.cells = [
        cell("kill-sim-walking", resumed_s=0.4),
        cell("kill-sim-pushing", resumed_s=0.6),
        cell("cut-agent-walking"),
    ]
    found.steps = [steps(0.001)]
    found.training = trained()
    return found


def test_they_are_read_again_as_they_were_written(tmp_path: Path, results: SoakResults) -> None:
    write_results(tmp_path, results)
    assert read_results(tmp_path) == results
    assert results.made["soak"]["versions"]["zenoh"]


def test_they_are_summarized_by_kind_and_kills_by_role_and_part(results: SoakResults) -> None:
    results.summarize()
    assert list(results.summary) == ["all", "kill", "cut"]
    assert results.summary["all"].n_as_expected == 3
    assert results.kills["sim"]["resumed_s"].median_s == 0.5
    assert results.kills["sim"]["resumed_s"].longest_s == 0.6
    assert "redo_s" not in results.kills["sim"]
    text = "\n".join(table_lines(results))
    assert "resumed" in text
    assert "500.0    600.0" in text
    assert "10 learners killed: the same as without" in text
    assert "80.0 MB, +0.10 %" in text


@pytest.mark.parametrize(
    "wrong",
    [cell("drop-sim-walking", survived=False), cell("drop-sim-walking", same=False), steps(0.02), trained("last")],
    ids=["ended", "differs", "grows", "other policy"],
)
def test_one_thing_that_is_wrong_makes_all_of_it_wrong(
    results: SoakResults, wrong: CellResult | StepsResult | TrainingResult
) -> None:
    assert results.is_as_expected
    if isinstance(wrong, CellResult):
        results.cells.append(wrong)
    elif isinstance(wrong, StepsResult):
        results.steps.append(wrong)
    else:
        results.training = wrong
    assert not results.is_as_expected
