"""Changes of a scenario, from texts such as `box.mass_kg=0.9`."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.errors import ConfigError, ScenarioError
from legpush.scenarios.changes import change_texts, override, parse_changes
from legpush.scenarios.file import load_scenario
from legpush.scene.station import at_station


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("3", 3),
        ("0.9", 0.9),
        (".5", 0.5),
        ("0.4x0.5x0.4", [0.4, 0.5, 0.4]),
        ("[0.4, 0.5]", [0.4, 0.5]),
        ("rrt_star", "rrt_star"),
        ('"a=b"', "a=b"),
        ("true", True),
    ],
)
def test_a_value_is_that_of_a_scenario_file_or_a_word(text: str, value: Any) -> None:
    assert parse_changes([f"some.field = {text}"]) == {"some.field": value}


@pytest.mark.parametrize("text", ["box.mass_kg", "=3", "box.mass_kg=", ""])
def test_a_text_that_is_no_change_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match=r"Expected FIELD=VALUE for --set, such as box\.mass_kg=0\.9, got"):
        parse_changes([text])


def test_a_field_is_changed_once() -> None:
    with pytest.raises(ConfigError, match=r"Expected each field once for --set, got a\.b twice"):
        parse_changes(["a.b=1", "a.b=2"])


def test_every_kind_of_field_can_be_changed() -> None:
    changes = parse_changes(
        ["box.size_m=0.3x0.4x0.4", "planning.planner=rrt", "mission.max_push_cycles=7", "realism.profile=real"]
    )
    changed = override(load_scenario("default"), changes)
    assert changed.box.size_m == (0.3, 0.4, 0.4)
    assert (changed.planning.planner, changed.mission.max_push_cycles) == ("rrt", 7)
    assert changed.realism.profile == "real"


def test_a_robot_at_its_station_stays_there_if_the_box_has_another_size() -> None:
    changed = override(load_scenario("push"), {"box.size_m": [0.5, 0.4, 0.4]})
    assert at_station(changed.robot, changed.start.pose(), changed.box, changed.box.pose.pose())
    away = load_scenario("default")
    assert override(away, {"box.size_m": [0.5, 0.4, 0.4]}).start == away.start


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"box.mass_kg": -1}, "--set: at `box.mass_kg`: expected a number from 0.001 to 1000, got -1"),
        ({"box.mas": 1}, "unknown field"),
        ({"bx.mass_kg": 1}, "--set: expected the path of a field, such as box.mass_kg, got bx.mass_kg"),
        ({"box": 1}, "--set: at `box`"),
    ],
)
def test_a_change_that_makes_no_scenario_is_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(ScenarioError, match=words):
        override(load_scenario("push"), changes, "--set")


TEXTS = st.text(st.characters(exclude_categories=("Cs", "Cc")))
VALUES = st.recursive(
    st.booleans() | st.integers(-(2**53), 2**53) | st.floats(allow_nan=False, allow_infinity=False) | TEXTS,
    lambda values: st.lists(values, max_size=3) | st.dictionaries(TEXTS, values, max_size=3),
    max_leaves=6,
)


@given(st.dictionaries(st.from_regex(r"[a-z_]{1,6}(\.[a-z_]{1,6}){0,2}", fullmatch=True), VALUES, max_size=3))
def test_changes_are_written_as_the_texts_that_they_are_read_from(changes: dict[str, Any]) -> None:
    assert parse_changes(change_texts(changes)) == changes
