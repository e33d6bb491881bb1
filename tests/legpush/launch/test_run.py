"""A run: what the options replace in its scenario, and whether it is over already."""

import json
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from legpush.errors import ScenarioError
from legpush.launch.run import finished_report, launch_mission
from legpush.options.run import RunOptions
from legpush.policy_names import DEFAULT_POLICY
from legpush.scenarios.file import dump_scenario, load_scenario


def test_options_replace_what_the_scenario_says() -> None:
    options = RunOptions(scenario="push", planner="rrt_star", changes=("box.mass_kg=0.9", "box.friction=0.3"))
    scenario = options.resolved_scenario()
    assert (scenario.planning.planner, scenario.box.mass_kg, scenario.box.friction) == ("rrt_star", 0.9, 0.3)
    assert RunOptions(scenario="push").resolved_scenario() == load_scenario("push")


def test_a_replaced_value_has_the_bounds_of_its_field() -> None:
    with pytest.raises(ScenarioError, match=r"--set: at `box\.mass_kg`: expected a number from 0\.001 to 1000, got -1"):
        RunOptions(scenario="push", changes=("box.mass_kg=-1",)).resolved_scenario()
    with pytest.raises(ScenarioError, match=r"--set: at `planning\.min_turning_radius_m`: expected a number from 0 to"):
        RunOptions(scenario="push", changes=("planning.min_turning_radius_m=1e308",)).resolved_scenario()


def left_by(folder: Path, seed: int = 3, policy: str = DEFAULT_POLICY, reason: str = "success") -> Path:
    """The folder of a run that has ended."""
    (folder / "logs").mkdir()
    (folder / "logs" / "command.txt").write_text(f"legpush run --seed {seed} --out '{folder}' --policy {policy}\n")
    (folder / "episode-0000.journal").touch()
    report = {"success": reason == "success", "seed": seed, "reason": reason}
    (folder / "report.json").write_text(json.dumps(report))
    return folder


@pytest.mark.parametrize(
    ("left", "options", "is_over"),
    [
        ({}, {}, True),
        ({"reason": "max_push_cycles"}, {}, True),
        ({"reason": "bad_answer"}, {}, False),
        ({}, {"seed": 4}, False),
        ({}, {"policy": "scripted"}, False),
        ({"policy": "scripted"}, {"policy": "scripted"}, True),
    ],
)
def test_a_mission_is_over_whose_report_is_that_of_the_same_command(
    left: dict[str, Any], options: dict[str, Any], is_over: bool, tmp_path: Path
) -> None:
    folder = left_by(tmp_path, **left)
    asked = RunOptions(scenario="push", out=folder, **{"seed": 3, **options})

    assert (finished_report(folder, asked) is not None) == is_over
    (folder / "report.json").unlink()
    assert finished_report(folder, asked) is None


def test_a_finished_mission_is_told_and_keeps_its_report(tmp_path: Path) -> None:
    folder = left_by(tmp_path, reason="stuck")
    (folder / "scenario.toml").write_text(dump_scenario(load_scenario("push")))
    before = (folder / "report.json").read_bytes()
    console = Console(file=StringIO(), width=200)

    assert launch_mission(RunOptions(scenario="push", seed=3, out=folder), console) == 1
    assert isinstance(console.file, StringIO)
    assert "finished already" in console.file.getvalue()
    assert (folder / "report.json").read_bytes() == before
    assert not list((folder / "logs").glob("*.log"))
