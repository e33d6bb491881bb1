"""Options of trainings: which of them go together."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from legpush.errors import ConfigError
from legpush.options.learning import SETTINGS, EvaluateOptions, TrainOptions


@pytest.mark.parametrize(
    ("given", "flag"),
    [
        ({"steps": 5120}, "--steps"),
        ({"seed": 77}, "--seed"),
        ({"world": "map"}, "--world"),
        ({"mass_kg": (1.0, 2.0)}, "--mass-kg"),
        ({"changes": ("room.slope_deg=3",)}, "--set"),
        ({"simulators": 7}, "--simulators"),
        ({"init": "variable"}, "--init"),
        ({"dry_run": True}, "--dry-run"),
    ],
)
def test_a_training_that_goes_on_keeps_its_settings(given: dict[str, Any], flag: str) -> None:
    options = TrainOptions(resume=Path("x"), **given)
    with pytest.raises(ConfigError, match=f"with its own settings, without {flag}$"):
        options.require_own_settings()
    TrainOptions(**given).require_own_settings()


@pytest.mark.parametrize("words", [("--world", "mujoco"), ("--world=mujoco",), ("--mass_kg", "1", "2"), ("--dry-run",)])
def test_a_setting_that_is_given_with_its_default_value_is_refused_as_well(words: tuple[str, ...]) -> None:
    options = TrainOptions(resume=Path("x"))
    options.require_own_settings(("--resume", "x", "--loggers", "csv"))
    flag = words[0].partition("=")[0].replace("_", "-")
    with pytest.raises(ConfigError, match=f"with its own settings, without {flag}$"):
        options.require_own_settings(("--resume", "x", *words))


def test_options_that_do_nothing_alone_are_refused() -> None:
    with pytest.raises(ConfigError, match="Expected --seeds with --workers"):
        TrainOptions(workers=2)
    TrainOptions(workers=2, seeds="1-3")
    TrainOptions(workers=2, resume=Path("x"))
    with pytest.raises(ConfigError, match="Expected --sweep with --grid"):
        EvaluateOptions(policy="scripted", grid=True)


def test_settings_that_a_training_keeps_are_options_of_it() -> None:
    assert set(SETTINGS) <= {field.name for field in fields(TrainOptions)}
