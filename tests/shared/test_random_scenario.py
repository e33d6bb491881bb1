"""Rooms that are drawn from a seed."""

from math import hypot
from pathlib import Path

import pytest

from legpush.cli import main
from legpush.errors import ConfigError
from legpush.random_room import RandomRoom
from legpush.random_scenario import random_scenario
from legpush.scenario_file import load_scenario
from legpush.scenario_file_checks import check_scenario


@pytest.mark.parametrize("seed", range(5))
def test_a_random_room_can_be_carried_out_and_is_what_was_asked_for(seed: int) -> None:
    options = RandomRoom(obstacles=8, push_m=1.5, mass_kg=0.9, friction=0.3)
    scenario = random_scenario(options, seed)

    check_scenario(scenario)
    assert len(scenario.room.obstacles) == 8
    assert (scenario.box.mass_kg, scenario.box.friction) == (0.9, 0.3)
    box, goal = scenario.box.pose, scenario.goal.pose
    assert hypot(box.x_m - goal.x_m, box.y_m - goal.y_m) >= 1.5
    assert random_scenario(options, seed) == scenario
    assert random_scenario(options, seed + 100) != scenario


def test_a_room_that_cannot_be_drawn_is_an_error() -> None:
    with pytest.raises(ConfigError, match="take fewer or smaller obstacles, or narrower corridors"):
        random_scenario(RandomRoom(size_m=(4.0, 4.0), obstacles=30, corridor_m=3.0), 0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"obstacle_m": (0.5, 0.2)}, "longest side of an obstacle, got 0.5 and 0.2"),
        ({"corridor_m": 9.0}, "a corridor narrower than the room, 8.0 m, got 9.0"),
        ({"obstacles": -1}, "0 to 1000 obstacles, got -1"),
    ],
)
def test_options_that_make_no_sense_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        RandomRoom(**options)  # type: ignore[arg-type]


def test_the_command_writes_a_file_that_can_be_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "room.toml"

    assert main(["scenarios", "random", str(path), "--seed", "4", "--obstacles", "3"]) == 0

    assert capsys.readouterr().out == f"wrote {path}\n"
    assert load_scenario(path) == random_scenario(RandomRoom(obstacles=3), 4)
    assert main(["scenarios", "random", str(path), "--seed", "4"]) == 2
    assert "expected a new file" in capsys.readouterr().err
