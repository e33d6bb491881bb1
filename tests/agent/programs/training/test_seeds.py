"""`legpush train --seeds`: the same trainings as one by one, interrupted and resumed."""

import io
import re
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.policies.folder import WEIGHTS_FILE
from agent_proc.profiles.profile import dump_profile
from agent_proc.programs import train as train_program
from agent_proc.programs.train import train
from agent_proc.programs.training import seeds
from agent_proc.simulators import simulators
from agent_proc.studies.seed_trainings import SUMMARY_FILE, seed_folder
from legpush.errors import INTERRUPTED, ConfigError
from legpush.options.learning import TrainOptions
from legpush.study.engines.inline import InlineEngine
from tests.agent.learning.small_training import small_profile


@pytest.fixture
def options(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> TrainOptions:
    """Trainings of 32 steps in the map, in this process."""
    monkeypatch.setattr(seeds, "LocalEngine", lambda _: InlineEngine())
    profile = tmp_path / "small.toml"
    profile.write_text(
        dump_profile(small_profile(steps=32, evaluate_every=32, evaluation_episodes=1)), encoding="utf-8"
    )
    return TrainOptions(profile=str(profile), seeds="1,2", world="map", simulators=2, out=tmp_path / "seeds")


def said(options: TrainOptions) -> tuple[int, str]:
    console = Console(file=io.StringIO(), width=200)
    return train(options, console), console.file.getvalue()  # type: ignore[attr-defined]


def test_each_seed_learns_what_it_learns_alone(
    options: TrainOptions, tmp_path: Path, stop: threading.Event, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(seeds, "stop_on_signals", lambda: stop)
    monkeypatch.setattr(train_program, "simulators", simulators)
    assert options.out is not None
    stop.set()
    code, text = said(options)
    assert code == INTERRUPTED
    assert f"interrupted: 0 of 2 cells; to go on: legpush train --resume {options.out}" in text

    stop.clear()
    code, text = said(TrainOptions(resume=options.out))
    assert code == 0
    assert re.search(r"position error \[cm\] +2 .*Student's t 95 %", text)
    assert (options.out / SUMMARY_FILE).is_file()

    assert said(replace(options, seeds=None, seed=2, out=tmp_path / "alone"))[0] == 0
    alone, among = (folder / "last" / WEIGHTS_FILE for folder in (tmp_path / "alone", seed_folder(options.out, 2)))
    assert alone.read_bytes() == among.read_bytes()
    other = seed_folder(options.out, 1) / "last" / WEIGHTS_FILE
    assert other.read_bytes() != among.read_bytes()


def test_seeds_that_contradict_other_options_are_refused(options: TrainOptions) -> None:
    for changes, match in (
        ({"seed": 3}, "Expected either --seed or --seeds"),
        ({"resume": Path("x"), "out": None}, "Expected either --resume DIR, which knows its seeds, or --seeds"),
        ({"seeds": "5-1"}, "Expected rising ranges"),
        ({"join": "run", "world": "mujoco"}, "Expected no --join and no --record with --seeds"),
    ):
        with pytest.raises(ConfigError, match=match):
            replace(options, **changes)
