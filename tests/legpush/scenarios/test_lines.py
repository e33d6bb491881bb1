"""Lines of keys in TOML and JSON texts, compared with what their readers find."""

import json
import re
import tomllib
from collections.abc import Iterator
from typing import Any

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from legpush.scenarios.file import scenario_names, scenario_source
from legpush.scenarios.lines import line_of, lines_of

TOML = '''\
# a comment with "quotes" = [
name = "a # b" # = "c"
"quoted key" = 1
a.b = 2
text = """
x = 1
[no]
"""
raw = \'\'\'
y = [ \'\'\'
[room]
size_m = [
    8.0, # wide
    6.0,
]
obstacles = [
    { x_min_m = 1, y_min_m = { deep = 2 } },
    # none
    { x_min_m = "}" },
]
[[stage]]
kind = 'arc'
[stage.end]
x = 1
[[stage]]
kind = "line"
[ last ]
when = 2026-01-01 10:00:00
'''
LINES = {
    "name": 2,
    "quoted key": 3,
    "a": 4,
    "a.b": 4,
    "text": 5,
    "raw": 9,
    "room": 11,
    "room.size_m": 12,
    "room.size_m[0]": 13,
    "room.size_m[1]": 14,
    "room.obstacles": 16,
    "room.obstacles[0]": 17,
    "room.obstacles[0].x_min_m": 17,
    "room.obstacles[0].y_min_m": 17,
    "room.obstacles[0].y_min_m.deep": 17,
    "room.obstacles[1]": 19,
    "room.obstacles[1].x_min_m": 19,
    "stage[0]": 21,
    "stage[0].kind": 22,
    "stage[0].end": 23,
    "stage[0].end.x": 24,
    "stage[1]": 25,
    "stage[1].kind": 26,
    "last": 27,
    "last.when": 28,
}


def paths(plain: Any, at: str = "") -> Iterator[str]:
    """Every key and element of a file as its reader has it."""
    if at:
        yield at
    if isinstance(plain, dict):
        for key, value in plain.items():
            yield from paths(value, f"{at}.{key}" if at else key)
    if isinstance(plain, list):
        for index, value in enumerate(plain):
            yield from paths(value, f"{at}[{index}]")


def test_each_key_has_its_line() -> None:
    tomllib.loads(TOML)
    assert lines_of(TOML) == LINES


@pytest.mark.parametrize(
    ("path", "line"), [("room.size_m[1]", 14), ("room.nothing.deep[3].x", 11), ("stage[1].end.x", 25), ("none", None)]
)
def test_what_is_not_there_has_the_line_of_the_table_around_it(path: str, line: int | None) -> None:
    assert line_of(path, LINES) == line


@pytest.mark.parametrize("name", scenario_names())
def test_every_key_of_a_scenario_has_a_line_with_that_key(name: str) -> None:
    text = scenario_source(name).read_text()
    lines = lines_of(text)
    found = [path for path in paths(tomllib.loads(text)) if path in lines]
    assert {path for path in paths(tomllib.loads(text)) if not path.endswith("]")} <= set(found) | {
        path for path in paths(tomllib.loads(text)) if any(other.startswith(f"{path}[") for other in lines)
    }
    for path in found:
        key = re.split(r"[.\[]", re.sub(r"\[\d+\]$", "", path))[-1]
        if not path.endswith("]"):
            assert key in text.splitlines()[lines[path] - 1]


VALUES = st.recursive(
    st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(st.characters(codec="ascii")),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.from_regex(r"\A[a-z_]{1,4}\Z"), inner, max_size=3),
    max_leaves=12,
)


@given(st.dictionaries(st.from_regex(r"\A[a-z_]{1,4}\Z"), VALUES, max_size=4))
def test_every_key_of_any_file_is_found(plain: dict[str, Any]) -> None:
    for text in (tomli_w.dumps(plain), json.dumps(plain, indent=1)):
        lines = lines_of(text)
        n_lines = text.count("\n") + 1
        assert all(1 <= line <= n_lines for line in lines.values())
        arrays = {path for path in paths(plain) if f"{path}[0]" in lines}
        assert set(paths(plain)) == set(lines) | arrays


@given(st.text(max_size=30))
def test_any_path_has_a_line_or_none(path: str) -> None:
    assert line_of(path, {}) is None
    assert line_of(path, {"": 1}) is None


@given(st.dictionaries(st.text(max_size=4), VALUES, max_size=4))
def test_keys_of_any_characters_are_walked_through(plain: dict[str, Any]) -> None:
    n_lines = {text: text.count("\n") + 1 for text in (tomli_w.dumps(plain), json.dumps(plain, indent=1))}
    assert all(1 <= line <= n for text, n in n_lines.items() for line in lines_of(text).values())
