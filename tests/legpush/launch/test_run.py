"""The scenario of a run: what the options replace in it."""

import pytest

from legpush.errors import ConfigError
from legpush.options.run import RunOptions
from legpush.scenarios.file import load_scenario


def test_options_replace_what_the_scenario_says() -> None:
    options = RunOptions(scenario="push", planner="rrt_star", box_mass_kg=0.9, box_friction=0.3)
    scenario = options.resolved_scenario()
    assert (scenario.planning.planner, scenario.box.mass_kg, scenario.box.friction) == ("rrt_star", 0.9, 0.3)
    assert RunOptions(scenario="push").resolved_scenario() == load_scenario("push")


def test_a_replaced_value_has_the_bounds_of_its_field() -> None:
    with pytest.raises(ConfigError, match=r"Expected 0\.001 to 1000 for --box-mass-kg, got -1\.0"):
        RunOptions(scenario="push", box_mass_kg=-1.0)
    with pytest.raises(ConfigError, match=r"Expected 0 to 1000 for --turning-radius-m, got 1e\+308"):
        RunOptions(scenario="push", turning_radius_m=1e308)
