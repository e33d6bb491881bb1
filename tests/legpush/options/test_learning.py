"""Options of trainings: which of them go together."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from legpush.errors import ConfigError
from legpush.options.learning import SETTINGS, TrainOptions


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


def test_settings_that_a_training_keeps_are_options_of_it() -> None:
    assert set(SETTINGS) <= {field.name for field in fields(TrainOptions)}
