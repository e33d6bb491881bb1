"""What cannot begin is refused before a process is started or a folder is made."""

import sys
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace
from rich.console import Console

from legpush.errors import ConfigError, LegpushError, OtherVersionError
from legpush.history.journal import Journal
from legpush.launch import run as launch
from legpush.launch.preflight import check_mission
from legpush.launch.process_commands import Programs
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS
from legpush.options.run import RunOptions
from legpush.scenarios.file import load_scenario
from tests.legpush.fakes import opened

FACTORIES = """
import os
import sys

def breaks():
    raise KeyError("no model here")

def ends():
    print("one")
    print("the licence has run out", file=sys.stderr, flush=True)
    os._exit(7)

def nothing():
    return None
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with a user's module and files that are no push maps or policies."""
    (tmp_path / "mine.py").write_text(FACTORIES)
    (tmp_path / "map.json").write_text("{}")
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"policy": "nosuch"}, r"Expected a policy \(dynamic_programming, .*variable.*got 'nosuch'"),
        ({"policy": "empty"}, r"empty/card\.json"),
        (
            {"changes": ("box.mass_kg=80",)},
            r"push: the box of 80 kg .* at least \d+ N .*lower `box\.mass_kg`",
        ),
        ({"policy": "json:loads"}, r"json:loads: the factory raised TypeError: loads\(\) missing 1 required"),
        ({"policy": "nowhere:make"}, "Expected module:factory that can be imported, got 'nowhere:make'"),
        ({"policy": "mine:breaks"}, "mine:breaks: the factory raised KeyError: 'no model here'"),
        ({"policy": "mine:nothing"}, "mine:nothing: expected a policy with a method `decide"),
        ({"push_map": Path("nowhere.json")}, r"nowhere\.json: expected a push map that `legpush calibrate` wrote"),
        (
            {"push_map": Path("map.json")},
            r"map\.json: at `box`: expected a value, got nothing\n.*map\.json: at `effects`: expected a value",
        ),
        ({"changes": ("planning.steering=dubins",)}, r"min_turning_radius_m above 0 m for the steering dubins, got 0"),
        (
            {
                "changes": ("planning.steering=reeds_shepp", "planning.min_turning_radius_m=0.5"),
                "planner": "prm_star",
            },
            r"a planner that can be steered by reeds_shepp \(rrt, .*\), got prm_star \(`planning` of the scenario",
        ),
        ({"out": Path("mine.py/run")}, r"for --out, got mine\.py/run \(Not a directory: .*mine\.py\)"),
        ({"out": Path("/proc/run")}, "for --out, got /proc/run"),
        ({"planner_command": "nosuchplanner --fast"}, "got 'nosuchplanner'"),
    ],
    ids=str,
)
def test_a_mission_that_cannot_begin_is_refused_before_anything_is_made(
    options: dict[str, Any], words: str, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def started(*_: object) -> None:
        raise AssertionError("it began")

    monkeypatch.setattr(launch, "_run_and_tell", started)
    before = set(here.iterdir())
    with pytest.raises(LegpushError, match=words) as refused:
        launch.launch_mission(RunOptions(scenario="push", **options), Console(file=StringIO()))
    assert refused.value.exit_code == 2
    assert {path for path in here.iterdir() if path.name != "__pycache__"} == before


def test_a_check_that_ends_otherwise_is_told_with_its_last_lines(here: Path) -> None:
    with pytest.raises(LegpushError) as refused:
        check_mission(RunOptions(policy="mine:ends"), load_scenario("push"), here / "run", Programs())
    assert refused.value.lines() == (
        "the check of the policy mine:ends exited with 7; its last lines:",
        "    the licence has run out",
    )
    assert refused.value.exit_code == 3


def test_further_flags_of_the_agent_are_checked(here: Path) -> None:
    programs = Programs(agent_flags=("--branch-of", "nowhere.mcap", "--branch-at", "0:1"))
    with pytest.raises(ConfigError, match=r"nowhere\.mcap"):
        check_mission(RunOptions(), load_scenario("push"), here / "run", programs)


def test_a_mission_of_this_package_alone_is_checked_without_a_process(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "executable", "/nowhere")
    for policy in ("scripted", "variable", "fixed"):
        check_mission(RunOptions(policy=policy), load_scenario("push"), here / "run", Programs())


@pytest.mark.parametrize(("motions", "refused"), [("1", True), (None, True), (str(MOTION_VERSION), False)])
def test_the_folder_of_another_version_is_not_that_of_another_scenario(
    here: Path, motions: str | None, refused: bool
) -> None:
    versions = {} if motions is None else {MOTIONS: motions}
    with Journal(here / "run" / "episode-0000.journal", replace(opened(), versions=versions)):
        (here / "run" / "scenario.toml").write_text("name = 'push'")
    options = RunOptions(scenario="push")
    if not refused:
        check_mission(options, load_scenario("push"), here / "run", Programs())
        return
    with pytest.raises(OtherVersionError, match=r"^other version: recorded .*; the mission in .* cannot go on here"):
        check_mission(options, load_scenario("push"), here / "run", Programs())
