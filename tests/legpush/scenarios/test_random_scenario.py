"""Rooms that are drawn from a seed."""

import subprocess
import sys
from math import hypot
from pathlib import Path

import pytest

from legpush.errors import ConfigError
from legpush.scenarios.checks import check_scenario
from legpush.scenarios.random_room import RandomRoom
from legpush.scenarios.random_scenario import random_scenario
from legpush.scene.scenario import Scenario


@pytest.mark.parametrize("seed", range(5))
def test_a_random_room_can_be_carried_out_and_is_what_was_asked_for(seed: int) -> None:
    options = RandomRoom(obstacles=8, push_m=1.5, mass_kg=0.9, friction=0.3)
    scenario = random_scenario(options, seed, anything)

    check_scenario(scenario)
    assert len(scenario.room.obstacles) == 8
    assert (scenario.box.mass_kg, scenario.box.friction) == (0.9, 0.3)
    box, goal = scenario.box.pose, scenario.goal.pose
    assert hypot(box.x_m - goal.x_m, box.y_m - goal.y_m) >= 1.5
    assert random_scenario(options, seed, anything) == scenario
    assert random_scenario(options, seed + 100, anything) != scenario


def test_a_room_that_cannot_be_drawn_is_an_error() -> None:
    with pytest.raises(ConfigError, match="take fewer or smaller obstacles, or narrower corridors"):
        random_scenario(RandomRoom(size_m=(4.0, 4.0), obstacles=30, corridor_m=3.0), 0, anything)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"obstacle_m": (0.5, 0.2)}, "longest side of an obstacle, got 0.5 and 0.2"),
        ({"corridor_m": 9.0}, "a corridor narrower than the room, 8.0 m, got 9.0"),
        ({"mass_kg": -1.0}, "0.001 to 1000 for mass_kg, got -1.0"),
        ({"friction": 0.0}, "1e-05 to 10 for friction, got 0.0"),
        ({"size_m": (float("inf"), 8.0)}, "at most 200 m for size_m, got inf"),
        ({"position_tolerance_m": -0.01}, "for position_tolerance_m, got -0.01"),
        ({"push_m": float("nan")}, "Expected 0 to 200 for push_m, got nan"),
        ({"obstacles": -1}, "0 to 1000 obstacles, got -1"),
    ],
)
def test_options_that_make_no_sense_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        RandomRoom(**options)  # type: ignore[arg-type]


def test_a_room_that_is_not_solvable_is_drawn_anew() -> None:
    first = random_scenario(RandomRoom(), 4, anything)

    second = random_scenario(RandomRoom(), 4, lambda scenario: scenario != first)

    assert second != first
    assert second.room != first.room
    with pytest.raises(ConfigError, match=r"None of 20 rooms was solvable"):
        random_scenario(RandomRoom(), 4, lambda _: False)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["here.toml"], "here.toml: expected a new file in an existing folder"),
        (["nowhere/room.toml"], "nowhere/room.toml: expected a new file in an existing folder"),
        (["room.toml", "--seed", "-1"], "for --seed, got -1"),
        (["room.toml", "--corridor-m", "9"], "a corridor narrower than the room, 8.0 m, got 9.0"),
    ],
)
def test_bad_input_is_refused_before_a_planner_starts(arguments: list[str], message: str, tmp_path: Path) -> None:
    (tmp_path / "here.toml").touch()
    command = [str(Path(sys.executable).with_name("legpush")), "scenarios", "random", *arguments]

    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    assert done.returncode == 2
    assert message in done.stderr


def anything(scenario: Scenario) -> bool:
    """Every room will do."""
    return True
