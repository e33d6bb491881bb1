"""The scenario of a run: what the options replace in it."""

import pytest

from legpush.errors import ScenarioError
from legpush.options.run import RunOptions
from legpush.scenarios.file import load_scenario


def test_options_replace_what_the_scenario_says() -> None:
    options = RunOptions(scenario="push", planner="rrt_star", box_mass_kg=0.9, box_friction=0.3)
    scenario = options.resolved_scenario()
    assert (scenario.planning.planner, scenario.box.mass_kg, scenario.box.friction) == ("rrt_star", 0.9, 0.3)
    assert RunOptions(scenario="push").resolved_scenario() == load_scenario("push")


def test_a_replaced_value_is_checked_as_in_a_file() -> None:
    with pytest.raises(ScenarioError, match=r"command line: at `box\.mass_kg`: expected a number >= 0\.001, got -1\.0"):
        RunOptions(scenario="push", box_mass_kg=-1.0).resolved_scenario()
