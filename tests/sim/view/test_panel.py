"""What controls may say."""

from math import nan
from types import SimpleNamespace
from typing import Any

import pytest

from sim_proc.view.panel import CAMERAS, JUMPS, KEYS, is_possible, speed_label, speed_of
from sim_proc.view.player import SPEEDS


@pytest.mark.parametrize(
    ("handle", "possible"),
    [
        ({"value": "Top", "options": ("Top", "Side")}, True),
        ({"value": "Below", "options": ("Top", "Side")}, False),
        ({"value": 3.5}, True),
        ({"value": True}, True),
        ({"value": nan}, False),
        ({"value": "3.5"}, False),
        ({"value": None}, False),
    ],
)
def test_what_no_control_can_say_is_told_from_what_one_can(handle: dict[str, Any], possible: bool) -> None:
    assert is_possible(SimpleNamespace(**handle)) is possible


@pytest.mark.parametrize("speed", SPEEDS)
def test_speeds_are_read_as_they_are_written(speed: float) -> None:
    assert speed_of(speed_label(speed)) == speed


def test_every_key_does_one_thing_and_every_camera_has_one() -> None:
    commands = [(name, value) for _, name, value in KEYS.values()]
    assert len(set(commands)) == len(commands)
    assert {value for name, value in commands if name == "camera"} == set(CAMERAS)
    assert {value for name, value in commands if name == "jump"} == set(JUMPS)
    assert ("play", None) in commands
