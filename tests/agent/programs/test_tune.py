"""`legpush tune`: a profile that `train` takes; what it was chosen by is refused where it is judged."""

import csv
import io
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.profiles.profile import dump_profile, load_profile
from agent_proc.programs import tune as program
from agent_proc.programs.train import train
from agent_proc.programs.tune import tune
from agent_proc.studies.comparison.contestants import cards_of, chosen_on, find_contestants
from legpush.errors import ConfigError, StopRequestedError
from legpush.options.learning import TrainOptions
from legpush.options.learning_tools import TuneOptions
from legpush.study.engines.inline import InlineEngine
from tests.agent.learning.small_training import small_profile

SPACE = '[search."settings.learning_rate"]\nlow = 1e-4\nhigh = 1e-2\nlog = true\n'


@pytest.fixture
def options(tmp_path: Path, stop: threading.Event, monkeypatch: pytest.MonkeyPatch) -> TuneOptions:
    """Two trials of 32 steps in the map, in this process."""
    monkeypatch.setattr(program, "LocalEngine", lambda _: InlineEngine())
    monkeypatch.setattr(program, "stop_on_signals", lambda: stop)
    (tmp_path / "space.toml").write_text(SPACE)
    small = dump_profile(small_profile(steps=32, evaluate_every=32, evaluation_episodes=1))
    (tmp_path / "small.toml").write_text(small, encoding="utf-8")
    return TuneOptions(
        profile=str(tmp_path / "small.toml"),
        space=str(tmp_path / "space.toml"),
        trials=2,
        seeds="1001",
        batch=2,
        episodes=2,
        simulators=2,
        distance_m=(0.1, 0.2),
        out=tmp_path / "tuned",
    )


def test_the_best_settings_are_a_profile_and_what_they_were_chosen_on_is_refused(
    options: TuneOptions, stop: threading.Event, tmp_path: Path
) -> None:
    folder = options.out
    assert folder is not None
    stop.set()
    with pytest.raises(StopRequestedError, match=r"0 of 2 cells of trials-0000-seed-1001 are kept; to go on: legpush"):
        tune(options, Console(file=io.StringIO()))
    stop.clear()
    console = Console(file=io.StringIO(), width=400)
    assert tune(options, console) == 0
    text = console.file.getvalue()  # type: ignore[attr-defined]
    best_profile = folder / "best.toml"
    assert (
        f"legpush train --world map --simulators 2 --profile {best_profile} --seeds 1-5 --distance-m 0.1 0.2\n" in text
    )
    rows = list(csv.DictReader(io.StringIO((folder / "trials.csv").read_text())))
    assert [row["trial"] for row in rows] == ["0", "1"]
    assert (folder / "tuning.png").read_bytes().startswith(b"\x89PNG")

    best = load_profile(str(folder / "best.toml"))
    assert best.tuned_on is not None
    assert best.tuned_on.training_seeds == (1001,)
    training = TrainOptions(profile=str(folder / "best.toml"), world="map", simulators=2, out=tmp_path / "training")
    for changes in ({"seed": 1001}, {"seeds": "1000-1002"}):
        with pytest.raises(ConfigError, match="Expected training seeds by which the profile was not tuned"):
            train(replace(training, **changes), Console(file=io.StringIO()))
    assert train(training, Console(file=io.StringIO())) == 0
    used = chosen_on(cards_of(find_contestants([str(tmp_path / "training")], "best")))
    assert used["the profile of a training"] == {3_000_000, 3_000_001}

    with pytest.raises(ConfigError, match="expected the folder of this tuning, got one with other episodes"):
        tune(replace(options, episodes=3), Console(file=io.StringIO()))


def test_without_optuna_the_extra_is_named(options: TuneOptions, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "optuna", None)
    monkeypatch.delitem(sys.modules, "agent_proc.studies.tuning.trials", raising=False)
    with pytest.raises(ConfigError, match=r"it needs optuna, .*'legpush\[tune\]' installs it"):
        tune(options, Console(file=io.StringIO()))
