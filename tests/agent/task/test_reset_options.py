"""Options of `reset`: what they may be, and what is said of others."""

from typing import Any

import numpy as np
import pytest

from agent_proc.task.reset_options import ResetOptions, read_options
from legpush.errors import ConfigError, ScenarioError
from legpush.scenarios.file import load_scenario


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (None, ResetOptions()),
        ({}, ResetOptions()),
        ({"scenario_seed": 0}, ResetOptions(scenario_seed=0)),
        ({"scenario_seed": np.int64(7)}, ResetOptions(scenario_seed=7)),
        ({"scenario": "open"}, ResetOptions(scenario=load_scenario("open"))),
        (
            {"scenario": load_scenario("push"), "scenario_seed": 2**32 - 1},
            ResetOptions(scenario=load_scenario("push"), scenario_seed=2**32 - 1),
        ),
    ],
)
def test_options_replace_what_is_drawn(given: object, expected: ResetOptions) -> None:
    assert read_options(given) == expected


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"scenari": 1}, ConfigError, "got 'scenari'; valid are `scenario` and `scenario_seed`$"),
        ({7: 1}, ConfigError, "got 7; valid are"),
        ([], ConfigError, r"a mapping for the options of reset, got \[\]; valid are"),
        ("scenario", ConfigError, "a mapping for the options of reset, got 'scenario'"),
        ({"scenario": None}, ConfigError, "for the option `scenario` of reset, got None"),
        ({"scenario": {"name": "open"}}, ConfigError, r"for the option `scenario` of reset, got \{'name'"),
        ({"scenario": "opne"}, ScenarioError, "opne"),
        ({"scenario_seed": -1}, ConfigError, "from 0 to 4294967295 for the option `scenario_seed` of reset, got -1"),
        ({"scenario_seed": 2**32}, ConfigError, "got 4294967296"),
        ({"scenario_seed": 1.5}, ConfigError, "got 1.5"),
        ({"scenario_seed": True}, ConfigError, "got True"),
        ({"scenario_seed": "7"}, ConfigError, "got '7'"),
        ({"scenario_seed": None}, ConfigError, "got None"),
    ],
)
def test_other_options_are_refused(given: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        read_options(given)
