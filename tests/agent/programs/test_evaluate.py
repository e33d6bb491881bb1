"""`legpush evaluate`: the files that it writes, and what it says."""

import csv
import io
import json
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from pyarrow import parquet
from rich.console import Console

from agent_proc.programs import evaluate
from agent_proc.programs.evaluate import run
from agent_proc.simulators import simulators
from legpush.errors import ConfigError, StopRequestedError
from legpush.options.learning import EvaluateOptions
from tests.agent.programs.conftest import stopping


@pytest.fixture
def options(tmp_path: Path) -> EvaluateOptions:
    return EvaluateOptions(
        policy="scripted", simulators=2, episodes=2, seed=40, sweep=("box.mass_kg=0.1,0.5",), out=tmp_path / "out"
    )


@pytest.mark.usefixtures("stop")
def test_it_evaluates_in_the_map(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evaluate, "simulators", simulators)
    options = EvaluateOptions(policy="variable", world="map", simulators=1, episodes=3, out=tmp_path / "out")

    assert run(options, Console(file=io.StringIO(), width=200)) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["world"] == "map"
    (case,) = summary["cases"].values()
    assert case["position_error_m"]["value"] < 0.01
    rows = list(csv.DictReader(io.StringIO((tmp_path / "out" / "episodes.csv").read_text())))
    assert [row["ending"] for row in rows] == ["done"] * 3
    known = ("max_abs_roll_deg", "max_abs_pitch_deg", "min_support_margin_m")
    assert [[row[name] for name in known] for row in rows] == [[""] * 3] * 3
    assert [case[name] for name in known] == [None] * 3
    schema = parquet.read_schema(tmp_path / "out" / "episodes.parquet")
    assert {str(schema.field(name).type) for name in known} == {"double"}


@pytest.mark.usefixtures("stop")
def test_it_writes_rows_summary_and_plot(options: EvaluateOptions) -> None:
    console, folder = Console(file=io.StringIO(), width=200), options.out
    assert folder is not None

    assert run(options, console) == 0
    rows = list(csv.DictReader(io.StringIO((folder / "episodes.csv").read_text())))
    assert [(row["case"], row["seed"]) for row in rows] == [
        (f"box.mass_kg={mass}", seed) for mass in ("0.1", "0.5") for seed in ("40", "41")
    ]
    assert parquet.read_table(folder / "episodes.parquet").num_rows == 4
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["policy"], summary["first_seed"], summary["episodes"]) == ("scripted", 40, 2)
    assert [case["n"] for case in summary["cases"].values()] == [2, 2]
    assert {case["success_rate"]["kind"] for case in summary["cases"].values()} == {"Wilson 95 %"}
    assert (folder / "evaluation.png").read_bytes().startswith(b"\x89PNG")
    said = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert said[0] == "judged on the scenario push"
    assert said[1].endswith("evaluating  4 of 4 episodes")
    assert said[2].startswith("box.mass_kg=0.1: position error ")
    assert "(Wilson 95 %, n 2)" in said[2]
    assert said[-1] == f"written to {folder}"
    assert not (folder / "finished.jsonl").exists()


@pytest.mark.usefixtures("stop")
def test_without_a_folder_it_makes_one_that_is_named_after_the_policy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    assert run(EvaluateOptions(policy="scripted", simulators=1, episodes=1), Console(file=io.StringIO())) == 0
    (folder,) = (tmp_path / "runs").iterdir()
    assert folder.name.endswith("-evaluate-scripted")
    assert (folder / "episodes.csv").is_file()


@pytest.mark.usefixtures("stop")
def test_a_folder_with_something_in_it_is_refused(options: EvaluateOptions) -> None:
    assert options.out is not None
    options.out.mkdir()
    (options.out / "notes.txt").touch()

    with pytest.raises(ConfigError, match=r"a new or empty folder for --out, or one with finished\.jsonl"):
        run(options, Console(file=io.StringIO()))
    assert [path.name for path in options.out.iterdir()] == ["notes.txt"]


def test_an_evaluation_that_is_interrupted_at_once_keeps_nothing(
    options: EvaluateOptions, stop: threading.Event
) -> None:
    assert options.out is not None
    stop.set()

    with pytest.raises(StopRequestedError, match="interrupted: no episode was finished"):
        run(options, Console(file=io.StringIO()))
    assert not list(options.out.glob("*.*"))
    stop.clear()
    assert run(options, Console(file=io.StringIO())) == 0


@pytest.mark.parametrize("n_finished", [1, 2, 3])
def test_an_interrupted_evaluation_goes_on_to_the_result_of_an_undisturbed_one(
    n_finished: int,
    options: EvaluateOptions,
    stop: threading.Event,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    options, folder = replace(options, simulators=1), options.out
    assert folder is not None
    whole = replace(options, out=tmp_path / "whole")
    assert run(whole, Console(file=io.StringIO())) == 0

    with monkeypatch.context() as patch:
        patch.setattr(evaluate, "simulators", stopping(stop, n_finished))
        words = f"interrupted: {n_finished} of 4 episodes are kept; to go on: legpush evaluate"
        with pytest.raises(StopRequestedError, match=words):
            run(options, Console(file=io.StringIO()))
    assert {path.name for path in folder.iterdir()} == {"finished.jsonl", "logs"}
    stop.clear()
    with (folder / "finished.jsonl").open("a") as file:
        file.write('["cut off by a ki')
    for other in (replace(options, policy="fixed"), replace(options, scenario="sine")):
        with pytest.raises(
            ConfigError, match=r"parts of the same work, got some with another (policy|scenario_sha256)"
        ):
            run(other, Console(file=io.StringIO()))

    console = Console(file=io.StringIO(), width=200)
    assert run(options, console) == 0
    said = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert said[:2] == [f"{n_finished} of 4 episodes are finished already", "judged on the scenario push"]
    for name in ("episodes.csv", "episodes.parquet", "summary.json"):
        assert (folder / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    assert not (folder / "finished.jsonl").exists()


def test_fewer_episodes_lose_none_that_are_finished(
    options: EvaluateOptions, stop: threading.Event, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = replace(options, sweep=(), episodes=4, simulators=1)
    folder = options.out
    assert folder is not None
    with monkeypatch.context() as patch:
        patch.setattr(evaluate, "simulators", stopping(stop, 3))
        with pytest.raises(StopRequestedError, match="3 of 4 episodes are kept"):
            run(options, Console(file=io.StringIO()))
    stop.clear()

    console = Console(file=io.StringIO(), width=200)
    assert run(replace(options, episodes=2), console) == 0
    assert len(parquet.read_table(folder / "episodes.parquet")) == 2
    assert "1 other finished episodes stay in finished.jsonl, for later" in console.file.getvalue()  # type: ignore[attr-defined]
    console = Console(file=io.StringIO(), width=200)
    assert run(options, console) == 0
    assert "3 of 4 episodes are finished already" in console.file.getvalue()  # type: ignore[attr-defined]
    assert len(parquet.read_table(folder / "episodes.parquet")) == 4
    assert not (folder / "finished.jsonl").exists()


@pytest.mark.usefixtures("stop")
def test_starts_are_those_of_the_task(options: EvaluateOptions) -> None:
    options = replace(options, sweep=(), task="push-l2", simulators=1)
    console, folder = Console(file=io.StringIO(), width=200), options.out
    assert folder is not None
    assert run(options, console) == 0
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["judged_on"].startswith("the task push-l2, in the scenario open; each start draws mass_kg, friction")
    assert f"judged on {summary['judged_on']}" in console.file.getvalue()  # type: ignore[attr-defined]


def test_a_sweep_of_what_the_starts_draw_is_refused(options: EvaluateOptions) -> None:
    with pytest.raises(ConfigError, match=r"for --sweep, got box\.mass_kg, which each start of the task draws; --task"):
        run(replace(options, task="push-l2"), Console(file=io.StringIO()))
    assert options.out is not None
    assert not options.out.exists()
