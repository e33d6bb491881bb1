"""Short scenario files: what has its default value is left out, and loading them gives the same scenario."""

import tomllib
from pathlib import Path
from typing import Any

import msgspec
import pytest
from msgspec.structs import replace

from legpush.scenarios.file import load_scenario, scenario_names
from legpush.scenarios.short import NOTE, short_scenario
from legpush.scene.plan_settings import Anytime, Smoothing
from legpush.scene.scenario import MissionSettings, Rectangle, Scenario

PUSH = load_scenario("push")
LATER = Rectangle(x_min_m=0.0, x_max_m=0.2, y_min_m=0.0, y_max_m=0.2, appears_at_s=3.0)
FULL = replace(
    PUSH,
    room=replace(PUSH.room, obstacles=(LATER,)),
    planning=replace(PUSH.planning, anytime=Anytime(n_improvements=3), smoothing=Smoothing(max_deviation_m=1.0)),
    mission=MissionSettings(max_push_cycles=77),
)


@pytest.mark.parametrize("scenario", [*map(load_scenario, scenario_names()), FULL], ids=lambda scenario: scenario.name)
def test_a_short_file_gives_an_equal_scenario_and_has_no_default_value(scenario: Scenario, tmp_path: Path) -> None:
    text = short_scenario(scenario)
    (tmp_path / "short.toml").write_text(text)

    assert load_scenario(tmp_path / "short.toml") == scenario
    assert text.startswith(NOTE)
    assert defaults_in(tomllib.loads(text), scenario) == []


def defaults_in(plain: dict[str, Any], record: msgspec.Struct) -> list[str]:
    """Names of fields that are written although they have their default."""
    found = []
    for field in msgspec.structs.fields(record):
        if field.name not in plain:
            continue
        value = getattr(record, field.name)
        if not field.required and value == field.default:
            found.append(field.name)
        if isinstance(value, msgspec.Struct):
            found += defaults_in(plain[field.name], value)
        elif isinstance(value, tuple):
            for part, each in zip(plain[field.name], value, strict=True):
                found += defaults_in(part, each) if isinstance(each, msgspec.Struct) else []
    return found
