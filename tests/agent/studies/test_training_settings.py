"""The command on the card of a trained policy makes the same plan again."""

import shlex
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.programs.training.plan import plan_of
from agent_proc.studies.training_cell import plan_of_cell, resolve
from agent_proc.studies.training_settings import TrainingCell
from legpush.arguments import parse
from legpush.options.learning import TrainOptions
from legpush.options.study import RunStudy
from legpush.study.file import load_study


def same(plan: TrainingPlan) -> TrainingPlan:
    """The plan without what differs between a cell and a command."""
    return replace(plan, command="")


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"seed": 3, "world": "map", "n_simulators": 2, "loggers": ("csv", "tensorboard"), "film_every": None},
        {"profile": "sac", "steps": 512, "entry": "fixed"},
        {"steps": 512, "init": "variable"},
        {"task": "push-l2", "world": "map_unknown", "mass_kg": (0.1, 0.5), "friction": (0.3, 0.4)},
        {"actions": "discrete", "entry": "fixed", "film_every": 2, "film_last": True},
        {"scenario": "open", "changes": {"box.mass_kg": 0.7, "box.size_m": [0.5, 0.4, 0.4], "box.shape": "cuboid"}},
        {"final_episodes": 5, "final_world": "map", "distance_m": (0.1, 1e-1)},
    ],
    ids=str,
)
def test_the_command_of_a_cell_is_that_of_a_training_with_the_same_plan(settings: dict[str, Any]) -> None:
    plan = plan_of_cell(resolve(TrainingCell(**settings), ()))

    legpush, train, *argv = shlex.split(plan.command)
    assert (legpush, train) == ("legpush", "train")
    options = parse(TrainOptions, "legpush train", argv)
    again = plan_of(options)
    assert same(again) == same(plan)
    assert again.command == plan.command


@pytest.mark.parametrize(
    "settings",
    [
        {"reward": "release", "changes": {"box.mass_kg": 0.7, "room.obstacles": []}},
        {"hidden": (32, 16), "normalize_observation": False, "seed": 4, "loggers": ("csv",)},
        {"profile": "100% 'mine'.toml", "n_steps": 64},
    ],
    ids=str,
)
def test_the_command_of_a_cell_with_other_settings_is_that_of_a_study(
    settings: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    builtin = Path(__file__).parents[3] / "agent_proc" / "profiles" / "tuned.toml"
    (tmp_path / "100% 'mine'.toml").write_text(builtin.read_text(encoding="utf-8"), encoding="utf-8")
    plan = plan_of_cell(resolve(TrainingCell(**settings), ()))

    write, run = plan.command.split(" && ")
    subprocess.run(["sh", "-c", write], check=True)
    options = parse(RunStudy, "legpush study run", shlex.split(run)[3:])
    (task,) = load_study(options.file, allowed_policies=options.policy).tasks()
    again = plan_of_cell(resolve(TrainingCell(**settings), ()))
    assert task.specification["command"] == again.command == plan.command
