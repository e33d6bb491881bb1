"""All schema errors of a file at once."""

from pathlib import Path
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.errors import MessageError, ScenarioError
from legpush.messages.codec import convert
from legpush.scenarios.file import load_scenario, scenario_names
from legpush.scenarios.schema_faults import schema_faults
from legpush.scene.scenario import Scenario
from legpush.schema_errors import explain

TEXT = """\
name = "my room"
seed = 3

[room]
size_m = [8.0, "wide"]
obstacles = [
    { x_min_m = 1.0, x_max_m = 2.0, y_min_m = 0.0, y_max_m = 1.0 },
    { x_min_m = 3.0, x_max_m = 2.0, y_min_m = 0.0, y_max_m = 1.0 },
    { x_min_m = 3.0, x_max_m = 4.0, y_min_m = 0.0, ymax_m = 1.0 },
]

[start]
x_m = 1.0
yaw_deg = 0.0

[box]
mass_kg = -1
[box.pose]
x_m = 3.0
y_m = 3.0
yaw_deg = 0.0

[planning]
steering = "dubin"
"""
TOLD = [
    (1, "at `name`: expected "),
    (2, "at `seed`: unknown field; valid here: name, "),
    (2, "at `goal`: expected a value, got nothing"),
    (5, "at `room.size_m[1]`: expected a number, got a text 'wide'"),
    (8, "at `room.obstacles[1]`: expected x_min_m < x_max_m, by at least "),
    (9, "at `room.obstacles[2].ymax_m`: unknown field (did you mean `y_max_m`?); valid here: x_min_m, "),
    (9, "at `room.obstacles[2].y_max_m`: expected a value, got nothing"),
    (12, "at `start.y_m`: expected a value, got nothing"),
    (17, "at `box.mass_kg`: expected a number from "),
    (24, "at `planning.steering`: expected one of dubins, reeds_shepp, straight, got 'dubin'"),
]


def test_every_error_of_a_file_is_told_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "room.toml"
    path.write_text(TEXT)
    with pytest.raises(ScenarioError) as refused:
        load_scenario(path)
    got = refused.value.lines()
    # A table that is missing from the file has no line, and is told first.
    missing = [(line, text) for line, text in TOLD if "`goal`" in text]
    expected = [f"{path}: {text}" for _, text in missing]
    expected += [f"{path}:{line}: {text}" for line, text in TOLD if (line, text) not in missing]
    assert [text[: len(begin)] for text, begin in zip(got, expected, strict=True)] == expected


def test_very_many_errors_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "room.toml"
    path.write_text("\n".join(f"key_{n} = 1" for n in range(40)))
    with pytest.raises(ScenarioError) as refused:
        load_scenario(path)
    assert len(refused.value.lines()) == 21
    assert refused.value.lines()[-1] == "and 25 more"


def plain_of(name: str) -> dict[str, Any]:
    plain: dict[str, Any] = msgspec.json.decode(msgspec.json.encode(load_scenario(name)))
    return plain


@given(data=st.data(), name=st.sampled_from(scenario_names()))
def test_a_file_with_one_error_has_the_fault_of_its_conversion_and_a_right_one_none(
    data: st.DataObject, name: str
) -> None:
    plain = plain_of(name)
    assert schema_faults(plain, Scenario, convert) == []
    table: Any = plain
    while True:
        key = data.draw(st.sampled_from(sorted(table) if isinstance(table, dict) else range(len(table))))
        if not (isinstance(table[key], dict | list) and table[key] and data.draw(st.booleans())):
            break
        table = table[key]
    table[key] = data.draw(st.sampled_from([{"no": 1}, "text", -1e9, [[]], True]))
    try:
        convert(plain, Scenario)
    except MessageError as error:
        first = explain(str(error), plain, Scenario)
        assert first in schema_faults(plain, Scenario, convert)
    else:
        assert schema_faults(plain, Scenario, convert) == []
