"""Scenarios that the schema allows and the room does not: refused with how far they are off."""

from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from legpush.errors import ScenarioError
from legpush.scenarios.checks import check_scenario
from legpush.scenarios.file import load_scenario
from tests.legpush.scenarios.small_scenario import Plain, plain_scenario, put, rear_only, write


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


ROOM_ERRORS: dict[str, tuple[Callable[[Plain], None], str]] = {
    "start in a wall": (
        put("start", "x_m", value=3.1),
        r"at `start`: expected at least 0\.442 m from the robot's trunk to `room\.obstacles\[0\]` \(0\.442 m for the "
        r"robot\), got an overlap of 0\.100 m",
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
        r"at `start`: expected the robot's trunk in the room, got it 1\.000 m outside",
    ),
    "start too near for some seeds": (
        put("randomization", "start_xy_m", value=0.5),
        r"at `start`: expected at least 1\.149 m .*0\.442 m for the robot and 0\.707 m for `randomization`",
    ),
    "start on the box": (
        put("start", value={"x_m": 5.2, "y_m": 2.5, "yaw_deg": 0.0}),
        r"at `start`: expected a distance between the robot's feet and the box, got an overlap",
    ),
    "box in a wall": (
        put("box", "pose", value={"x_m": 3.1, "y_m": 1.5, "yaw_deg": 0.0}),
        r"at `box\.pose`: .*from the box to `room\.obstacles\[0\]`, got an overlap of ",
    ),
    "box outside": (
        put("box", "pose", "x_m", value=9.0),
        r"at `box\.pose`: expected the box in the room, got it 1\.200 m outside",
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
        r"at `goal\.pose`: .*from the box at its goal to `room\.obstacles\[0\]`, got an overlap",
    ),
    "goal outside": (
        put("goal", "pose", "x_m", value=7.9),
        r"at `goal\.pose`: expected the box at its goal in the room, got it 0\.100 m outside",
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
        put("room", "resolution_m", value=0.001),
        r"at `room\.resolution_m`: expected at most 16777216 cells",
    ),
}


@pytest.mark.parametrize(("edit", "words"), ROOM_ERRORS.values(), ids=ROOM_ERRORS)
def test_what_has_no_space_is_refused_with_how_far_it_is_off(
    edit: Callable[[Plain], None], words: str, tmp_path: Path
) -> None:
    plain = plain_scenario()
    edit(plain)
    with pytest.raises(ScenarioError, match=r"small\.toml:\d+: " + words):
        load_scenario(write(tmp_path, plain))


def test_the_scenario_that_these_edits_start_from_is_valid(tmp_path: Path) -> None:
    assert load_scenario(write(tmp_path, plain_scenario())).name == "small"


def test_a_record_can_be_checked_without_a_file() -> None:
    scenario = load_scenario("push")
    with pytest.raises(ScenarioError, match="reset: at `start`"):
        check_scenario(msgspec.structs.replace(scenario, start=scenario.box.pose), "reset")


def test_everything_that_has_no_space_is_told_at_once_but_what_follows_from_it_is_not(tmp_path: Path) -> None:
    plain = plain_scenario()
    plain["start"]["x_m"] = -1.0
    plain["goal"]["pose"]["x_m"] = 40.0
    plain["planning"] = {"steering": "dubins"}
    path = write(tmp_path, plain)
    with pytest.raises(ScenarioError) as refused:
        load_scenario(path)
    lines = path.read_text().splitlines()
    begins = [
        f"{path}:{lines.index(table) + 1}: at `{field}`: expected "
        for table, field in (
            ("[start]", "start"),
            ("[goal.pose]", "goal.pose"),
            ("[planning]", "planning.min_turning_radius_m"),
        )
    ]
    told = refused.value.lines()
    assert [
        text
        for text, begin in zip(told, sorted(begins, key=lambda b: int(b.split(":")[1])), strict=True)
        if not text.startswith(begin)
    ] == []
