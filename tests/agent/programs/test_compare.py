"""`legpush compare`: the table, its files, an interruption, and what is refused."""

import io
import json
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.evaluation.starts import FIRST_CHECK_SEED
from agent_proc.programs import compare as program
from agent_proc.programs.compare import compare
from agent_proc.studies.comparison import constants
from legpush.arguments import OutputOptions
from legpush.errors import ConfigError, StopRequestedError
from legpush.options.learning_tools import CompareOptions
from legpush.output.reply import replying
from legpush.study.engines.inline import InlineEngine


@pytest.fixture
def stop(monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """The event that a signal sets; cells run in this process, and the grid of constants is small."""
    event = threading.Event()
    monkeypatch.setattr(program, "LocalEngine", lambda _: InlineEngine())
    monkeypatch.setattr(program, "stop_on_signals", lambda: event)
    monkeypatch.setattr(constants, "action_grid", lambda _: [(0.6, 0.0, -1.0, -0.5), (0.6, 0.0, 1.0, -0.5)])
    monkeypatch.setattr(constants, "ROUNDS", (1,))
    return event


def said(options: CompareOptions) -> str:
    console = Console(file=io.StringIO(), width=400)
    assert compare(options, console) == 0
    return str(console.file.getvalue())  # type: ignore[attr-defined]


def test_a_comparison_goes_on_after_an_interruption_to_tables_and_files(
    stop: threading.Event, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = CompareOptions(runs=("variable",), world="map_mean", search_world="map", episodes=2, out=tmp_path / "c")
    stop.set()
    with pytest.raises(StopRequestedError, match=r"interrupted: 0 of 2 cells of constants-1 are kept; to go on: leg"):
        compare(options, Console(file=io.StringIO()))
    stop.clear()
    text = said(options)

    lines = [line.split()[0] for line in text.splitlines() if line and line[0] != " "]
    assert lines[:4] == ["variable", "zero", "random", "constant"]
    assert {"comparison.json", "comparison.csv", "comparison.png"} <= {path.name for path in (tmp_path / "c").iterdir()}

    with replying(OutputOptions(json=True)):
        assert compare(options, Console(file=io.StringIO())) == 0
    plain = json.loads(capsys.readouterr().out)
    assert plain == json.loads((tmp_path / "c" / "comparison.json").read_bytes())
    assert [entry["n_starts"] for entry in plain["entries"]] == [2, 2, 2, 2]


def test_starts_on_which_the_best_policy_was_chosen_are_refused(tmp_path: Path) -> None:
    options = CompareOptions(runs=("variable/",), out=tmp_path / "c")
    with pytest.raises(ConfigError, match="Expected one of"):
        compare(replace(options, runs=("scripted",), against="nobody"), Console())
    folder = Path(program.__file__).parents[1] / "policies" / "variable"
    with pytest.raises(ConfigError, match="such as 1000000, by which the best policy of a training was chosen"):
        compare(replace(options, runs=(str(folder),), seed=FIRST_CHECK_SEED), Console())
    with pytest.raises(ConfigError, match="Expected at least one RUN"):
        replace(options, runs=())
