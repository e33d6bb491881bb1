"""Scenario files: what loads, what comes back, and what is refused with which words."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from legpush.errors import ScenarioError
from legpush.scenarios.checks import check_scenario
from legpush.scenarios.file import copy_scenario, dump_scenario, load_scenario, scenario_names
from legpush.scene.scenario import Box, Goal, PlanSettings, PoseDeg, Rectangle, Room, Scenario

Plain = dict[str, Any]


def plain_scenario() -> Plain:
    """A small valid scenario as a file says it: a wall at x 4.0 to 4.2 between the start and the box."""
    return {
        "name": "small",
        "room": {
            "size_m": [8.0, 5.0],
            "obstacles": [{"x_min_m": 3.0, "x_max_m": 3.2, "y_min_m": 0.0, "y_max_m": 2.0}],
        },
        "start": {"x_m": 1.0, "y_m": 1.0, "yaw_deg": 0.0},
        "box": {"pose": {"x_m": 5.5, "y_m": 2.5, "yaw_deg": 0.0}},
        "goal": {"pose": {"x_m": 6.5, "y_m": 2.5, "yaw_deg": 0.0}},
    }


def write(folder: Path, plain: Plain) -> Path:
    path = folder / "small.toml"
    path.write_text(tomli_w.dumps(plain))
    return path


def put(*place: str | int, value: Any) -> Callable[[Plain], None]:
    """An edit that sets the value at a path of keys and indices."""

    def edit(plain: Plain) -> None:
        node: Any = plain
        for step in place[:-1]:
            node = node[step] if isinstance(step, int) else node.setdefault(step, {})
        node[place[-1]] = value

    return edit


def rear_only(edit: Callable[[Plain], None]) -> Callable[[Plain], None]:
    """The same, and no face but the rear one may be pushed."""

    def edits(plain: Plain) -> None:
        edit(plain)
        put("pushing", "faces", value=["rear"])(plain)

    return edits


def drop(table: str, field: str) -> Callable[[Plain], None]:
    def edit(plain: Plain) -> None:
        del plain[table][field]

    return edit


# -- what loads ------------------------------------------------------------------------------------------------------


def test_there_are_seven_built_in_scenarios() -> None:
    names = ("blocked_way", "default", "dubins_loop", "published", "published_detour", "push", "sine")
    assert scenario_names() == names


@pytest.mark.parametrize("name", scenario_names())
def test_a_built_in_scenario_survives_being_written_and_read(name: str, tmp_path: Path) -> None:
    scenario = load_scenario(name)
    path = tmp_path / "again.toml"
    path.write_text(dump_scenario(scenario))
    assert load_scenario(path) == scenario
    assert scenario.name == name


@given(
    mass_kg=st.floats(min_value=0.001, allow_infinity=False, allow_nan=False),
    margin_m=st.floats(min_value=0.0, max_value=0.3),
    description=st.text(st.characters(exclude_categories=["Cs"])),
)
def test_every_number_and_text_survives_being_written_and_read(
    mass_kg: float, margin_m: float, description: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    scenario = Scenario(
        name="any",
        description=description,
        room=Room(size_m=(8.0, 5.0)),
        start=PoseDeg(x_m=1.0, y_m=1.0, yaw_deg=0.0),
        box=Box(pose=PoseDeg(x_m=4.5, y_m=2.5, yaw_deg=0.0), mass_kg=mass_kg),
        goal=Goal(pose=PoseDeg(x_m=5.5, y_m=2.5, yaw_deg=0.0)),
        planning=PlanSettings(margin_m=margin_m),
    )
    path = tmp_path_factory.mktemp("any") / "any.toml"
    path.write_text(dump_scenario(scenario), encoding="utf-8")
    assert load_scenario(path) == scenario


def test_a_path_may_be_given_as_text(tmp_path: Path) -> None:
    path = write(tmp_path, plain_scenario())
    assert load_scenario(str(path)) == load_scenario(path)


def test_whole_numbers_serve_as_lengths(tmp_path: Path) -> None:
    plain = plain_scenario()
    put("start", "x_m", value=1)(plain)
    assert load_scenario(write(tmp_path, plain)).start.x_m == 1.0


def test_the_published_map_stands_as_matlab_reads_it() -> None:
    room = load_scenario("published").room
    assert room.size_m == (60.0, 60.0)
    inner = {(r.x_min_m, r.x_max_m, r.y_min_m, r.y_max_m) for r in room.obstacles if 1 < r.y_max_m - r.y_min_m < 5}
    assert inner == {
        (0.0, 15.0, 49.0, 51.0),
        (19.0, 60.0, 29.0, 31.0),
        (0.0, 30.0, 9.0, 11.0),
    }


def test_a_copied_scenario_loads_from_where_it_was_copied_to(tmp_path: Path) -> None:
    written = copy_scenario("published", tmp_path / "mine.toml")
    assert written == (tmp_path / "mine.toml", tmp_path / "published_map.csv")
    assert load_scenario(tmp_path / "mine.toml") == load_scenario("published")


def test_copying_never_overwrites(tmp_path: Path) -> None:
    copy_scenario("default", tmp_path / "mine.toml")
    with pytest.raises(ScenarioError, match=r"mine\.toml: expected a new file"):
        copy_scenario("push", tmp_path / "mine.toml")
    assert load_scenario(tmp_path / "mine.toml").name == "default"


def test_an_obstacle_is_there_from_the_start_unless_it_says_otherwise(tmp_path: Path) -> None:
    plain = plain_scenario()
    plain["room"]["obstacles"].append({**plain["room"]["obstacles"][0], "appears_at_s": 12.5})
    scenario = load_scenario(write(tmp_path, plain))
    assert [obstacle.appears_at_s for obstacle in scenario.room.obstacles] == [0.0, 12.5]
    again = tmp_path / "again.toml"
    again.write_text(dump_scenario(scenario))
    assert load_scenario(again) == scenario


@pytest.mark.parametrize("place", ["start", "box", "goal"])
def test_an_obstacle_may_appear_where_none_may_stand(place: str, tmp_path: Path) -> None:
    plain = plain_scenario()
    x_m, y_m = {"start": (1.0, 1.0), "box": (5.5, 2.5), "goal": (6.5, 2.5)}[place]
    rectangle = {"x_min_m": x_m - 0.3, "x_max_m": x_m + 0.3, "y_min_m": y_m - 0.3, "y_max_m": y_m + 0.3}
    plain["room"]["obstacles"].append({**rectangle, "appears_at_s": 3.0})
    assert len(load_scenario(write(tmp_path, plain)).room.obstacles) == 2
    plain["room"]["obstacles"][1]["appears_at_s"] = 0.0
    with pytest.raises(ScenarioError, match=r"to `room\.obstacles\[1\]`"):
        load_scenario(write(tmp_path, plain))


# -- what is refused -------------------------------------------------------------------------------------------------

SCHEMA_ERRORS: dict[str, tuple[Callable[[Plain], None], str]] = {
    "unknown field": (
        put("box", "mas_kg", value=1.0),
        r"at `box\.mas_kg`: unknown field \(did you mean `mass_kg`\?\); valid here: pose, size_m, shape, mass_kg, fric",
    ),
    "unknown table": (
        put("planing", "planner", value="rrt"),
        r"at `planing`: unknown field \(did you mean `planning`\?\)",
    ),
    "field of the room that is neither its own nor a grid's": (
        put("room", "grid", value="a.csv"),
        r"at `room\.grid`: unknown field .*valid here: size_m, .*, grid_file, cell_m, first_row",
    ),
    "missing field": (drop("start", "x_m"), r"at `start\.x_m`: expected a value, got nothing"),
    "negative mass": (put("box", "mass_kg", value=-1.0), r"at `box\.mass_kg`: expected a number >= 0\.001, got -1\.0"),
    "mistyped number": (put("start", "y_m", value="1"), r"at `start\.y_m`: expected a number, got a text '1'"),
    "truth value for a number": (
        put("box", "friction", value=True),
        r"at `box\.friction`: expected a number, got a truth",
    ),
    "number for a table": (put("goal", value=3), r"at `goal`: expected a table, got a whole number 3"),
    "unknown planner": (
        put("planning", "planner", value="prm"),
        r"at `planning\.planner`: expected one of bit_star, informed_rrt_star, prm_star, rrt, .*, got 'prm'",
    ),
    "not a number": (put("start", "x_m", value=float("nan")), r"at `start\.x_m`: expected a finite number, got nan"),
    "infinite": (
        put("goal", "pose", "x_m", value=float("inf")),
        r"at `goal\.pose\.x_m`: expected a finite number, got inf",
    ),
    "infinite mass": (
        put("box", "mass_kg", value=float("inf")),
        r"at `box\.mass_kg`: expected a finite number, got inf",
    ),
    "too few numbers": (put("room", "size_m", value=[8.0]), r"at `room\.size_m`: expected an array of length 2, got 1"),
    "no area": (
        put("room", "obstacles", 0, "x_max_m", value=2.0),
        r"at `room\.obstacles\[0\]`: expected x_min_m < x_max_m, got 3\.0 and 2\.0",
    ),
    "time before the reset": (
        put("room", "obstacles", 0, "appears_at_s", value=-0.5),
        r"at `room\.obstacles\[0\]\.appears_at_s`: expected a number >= 0\.0, got -0\.5",
    ),
    "mistyped time": (
        put("room", "obstacles", 0, "apears_at_s", value=1.0),
        r"at `room\.obstacles\[0\]\.apears_at_s`: unknown field \(did you mean `appears_at_s`\?\)",
    ),
    "name with a slash": (put("name", value="a/b"), r"at `name`: expected a text matching regex .*, got 'a/b'"),
    "no budget": (put("planning", "max_iterations", value=0), r"at `planning\.max_iterations`: .* >= 1, got 0"),
}


@pytest.mark.parametrize(("edit", "words"), SCHEMA_ERRORS.values(), ids=SCHEMA_ERRORS)
def test_a_schema_error_names_file_field_expectation_and_value(
    edit: Callable[[Plain], None], words: str, tmp_path: Path
) -> None:
    plain = plain_scenario()
    edit(plain)
    with pytest.raises(ScenarioError, match=r"small\.toml: " + words):
        load_scenario(write(tmp_path, plain))


ROOM_ERRORS: dict[str, tuple[Callable[[Plain], None], str]] = {
    "start in a wall": (
        put("start", "x_m", value=3.1),
        r"at `start`: expected at least 0\.442 m from the robot's trunk to `room\.obstacles\[0\]` \(0\.442 m for the "
        r"robot\), got 0\.100 m inside: 0\.542 m too little",
    ),
    "start near a wall": (put("start", "x_m", value=2.6), r"at `start`: .*obstacles\[0\].*got 0\.400 m: 0\.042 m too"),
    "start right of a wall": (
        put("start", value={"x_m": 3.5, "y_m": 1.0, "yaw_deg": 0.0}),
        r"at `start`: .*obstacles\[0\].*got 0\.300 m: 0\.142 m too little",
    ),
    "start above a wall": (
        put("start", value={"x_m": 3.1, "y_m": 2.3, "yaw_deg": 0.0}),
        r"at `start`: .*obstacles\[0\].*got 0\.300 m: 0\.142 m too little",
    ),
    "start outside": (
        put("start", "y_m", value=-1.0),
        r"at `start`: .* border of the room .*got 1\.000 m inside: 1\.442",
    ),
    "start too near for some seeds": (
        put("randomization", "start_xy_m", value=0.5),
        r"at `start`: expected at least 1\.149 m .*0\.442 m for the robot and 0\.707 m for `randomization`",
    ),
    "start on the box": (
        put("start", value={"x_m": 5.2, "y_m": 2.5, "yaw_deg": 0.0}),
        r"at `start`: .* between the robot's feet and the box.* inside",
    ),
    "box in a wall": (
        put("box", "pose", value={"x_m": 3.1, "y_m": 1.5, "yaw_deg": 0.0}),
        r"at `box\.pose`: .*from the box to `room\.obstacles\[0\]`.* inside",
    ),
    "box outside": (
        put("box", "pose", "x_m", value=9.0),
        r"at `box\.pose`: .*from the box to the border of the room, got 1\.200 m inside",
    ),
    "box too near for some seeds": (
        put("randomization", "box_xy_m", value=2.0),
        r"at `box\.pose`: expected at least 2\.828 m from the box .*for `randomization`",
    ),
    "no place behind the box": (
        rear_only(put("box", "pose", value={"x_m": 4.2, "y_m": 1.5, "yaw_deg": 0.0})),
        r"at `box\.pose`: .*place where walking ends, 0\.75 m behind the rear face, to `room\.obstacles\[0\]`",
    ),
    "no place behind any face": (
        put("box", "pose", value={"x_m": 7.6, "y_m": 0.4, "yaw_deg": 0.0}),
        r"at `box\.pose`: .*; nor is there space at another face",
    ),
    "no face that can be pushed": (
        lambda plain: plain.update(box={**plain["box"], "shape": "wedge"}, pushing={"faces": ["left"]}),
        r"at `pushing\.faces`: expected a face that a wedge can be pushed at \(rear\), got left",
    ),
    "goal in a wall": (
        put("goal", "pose", value={"x_m": 3.0, "y_m": 1.0, "yaw_deg": 0.0}),
        r"at `goal\.pose`: .*from the box at its goal to `room\.obstacles\[0\]`.* inside",
    ),
    "goal outside": (
        put("goal", "pose", "x_m", value=7.9),
        r"at `goal\.pose`: .*border of the room, got 0\.100 m inside",
    ),
    "no place behind the box at its goal": (
        rear_only(put("goal", "pose", value={"x_m": 3.5, "y_m": 1.0, "yaw_deg": 0.0})),
        r"at `goal\.pose`: .*the robot's place behind the rear face of the box at its goal to `room\.obstacles\[0\]`",
    ),
    "obstacle elsewhere": (
        put("room", "obstacles", 0, value={"x_min_m": 9.0, "x_max_m": 10.0, "y_min_m": 0.0, "y_max_m": 1.0}),
        r"at `room\.obstacles\[0\]`: expected a rectangle in the room, x 0 to 8\.0",
    ),
    "obstacle that appears elsewhere": (
        put(
            *("room", "obstacles", 0),
            value={"x_min_m": 9.0, "x_max_m": 10.0, "y_min_m": 0.0, "y_max_m": 1.0, "appears_at_s": 5.0},
        ),
        r"at `room\.obstacles\[0\]`: expected a rectangle in the room, x 0 to 8\.0",
    ),
    "too many cells": (
        put("room", "resolution_m", value=1e-4),
        r"at `room\.resolution_m`: expected at most 16777216 cells",
    ),
}


@pytest.mark.parametrize(("edit", "words"), ROOM_ERRORS.values(), ids=ROOM_ERRORS)
def test_what_has_no_space_is_refused_with_how_far_it_is_off(
    edit: Callable[[Plain], None], words: str, tmp_path: Path
) -> None:
    plain = plain_scenario()
    edit(plain)
    with pytest.raises(ScenarioError, match=r"small\.toml: " + words):
        load_scenario(write(tmp_path, plain))


def test_the_scenario_that_these_edits_start_from_is_valid(tmp_path: Path) -> None:
    assert load_scenario(write(tmp_path, plain_scenario())).name == "small"


def test_a_record_can_be_checked_without_a_file() -> None:
    scenario = load_scenario("push")
    with pytest.raises(ScenarioError, match="reset: at `start`"):
        check_scenario(msgspec.structs.replace(scenario, start=scenario.box.pose), "reset")


def test_an_unknown_name_lists_the_valid_ones_and_the_nearest() -> None:
    with pytest.raises(
        ScenarioError,
        match=r"blocked_way, default, dubins_loop, .*, push, sine.*got `defalt` .*mean `default`",
    ):
        load_scenario("defalt")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"name = ", r"small\.toml: expected TOML \(Invalid value \(at end of document\)\)"),
        (b'name = "\xff"', r"small\.toml: expected UTF-8 text"),
        (None, r"small\.toml: expected a readable scenario file \(No such file"),
    ],
)
def test_a_file_that_is_no_toml_is_refused(content: bytes | None, words: str, tmp_path: Path) -> None:
    path = tmp_path / "small.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ScenarioError, match=words):
        load_scenario(path)


# -- grid files ------------------------------------------------------------------------------------------------------


def grid_scenario(folder: Path, cells: str, **room: Any) -> Path:
    """The small scenario with its room from a grid; `room` replaces fields of the room, None drops one."""
    (folder / "cells.csv").write_text(cells)
    plain = plain_scenario()
    fields = {"grid_file": "cells.csv", "cell_m": 1.0, "first_row": "top"} | room
    plain["room"] = {key: value for key, value in fields.items() if value is not None}
    return write(folder, plain)


CELLS = "1,1,0,0,0,0,0,0\n" + "0,0,0,0,0,0,0,0\n" * 4


@pytest.mark.parametrize(("first_row", "y_min_m"), [("top", 4.0), ("bottom", 0.0)])
def test_the_first_row_lies_where_the_file_says(first_row: str, y_min_m: float, tmp_path: Path) -> None:
    path = grid_scenario(tmp_path, CELLS, first_row=first_row)
    if first_row == "bottom":
        path.write_text(path.read_text().replace("y_m = 1.0", "y_m = 3.0"))
    room = load_scenario(path).room
    assert room.size_m == (8.0, 5.0)
    assert room.obstacles == (Rectangle(x_min_m=0.0, x_max_m=2.0, y_min_m=y_min_m, y_max_m=y_min_m + 1.0),)


def test_obstacles_may_be_added_to_a_grid(tmp_path: Path) -> None:
    extra = {"x_min_m": 3.0, "x_max_m": 3.2, "y_min_m": 0.0, "y_max_m": 2.0}
    room = load_scenario(grid_scenario(tmp_path, CELLS, obstacles=[extra])).room
    assert [r.x_min_m for r in room.obstacles] == [3.0, 0.0]


@pytest.mark.parametrize(
    ("cells", "room", "words"),
    [
        (CELLS, {"first_row": "up"}, r"small\.toml: at `room\.first_row`: expected one of bottom, top, got 'up'"),
        (CELLS, {"first_row": None}, r"small\.toml: at `room\.first_row`: expected a value, got nothing"),
        (CELLS, {"grid_file": None}, r"small\.toml: at `room\.grid_file`: expected a value, got nothing"),
        (CELLS, {"cell_m": 0.0}, r"small\.toml: at `room\.cell_m`: expected a number > 0\.0, got 0\.0"),
        (CELLS, {"size_m": [8.0, 5.0]}, r"small\.toml: at `room\.size_m`: expected nothing, since `room\.grid_file`"),
        (CELLS, {"obstacles": 3}, r"small\.toml: at `room\.obstacles`: expected an array, got a whole number 3"),
        (CELLS, {"grid_file": "no.csv"}, r"no\.csv: expected a readable grid file"),
        ("", {}, r"cells\.csv: expected 1 to 4096 rows and columns of cells, got none"),
        ("0,0\n0\n", {}, r"cells\.csv: expected 2 cells in row 2 as in row 1, got 1"),
        ("0,0\n0,2\n", {}, r"cells\.csv: expected 0 or 1 in row 2, column 2, got `2`"),
        ("0,0\n0,nan\n", {}, r"cells\.csv: expected 0 or 1 in row 2, column 2, got `nan`"),
    ],
)
def test_a_bad_grid_is_refused_with_file_row_and_column(
    cells: str, room: dict[str, Any], words: str, tmp_path: Path
) -> None:
    with pytest.raises(ScenarioError, match=words):
        load_scenario(grid_scenario(tmp_path, cells, **room))
