"""Scenario files: what loads, what comes back, and what is refused with which words."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush.bounds import LEAST_BOX_MASS_KG, MAX_BOX_MASS_KG
from legpush.errors import ScenarioError
from legpush.scenarios.file import copy_scenario, dump_scenario, load_scenario, scenario_names
from legpush.scene.plan_settings import PlanSettings
from legpush.scene.robot_motion import FallLimits
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from tests.legpush.scenarios.small_scenario import plain_scenario, put, write
from tests.robots import ROBOT, scaled_robot


def test_there_are_nine_built_in_scenarios() -> None:
    names = ("blocked_way", "default", "dubins_loop", "open", "open_real", "published", "published_detour", "push")
    assert scenario_names() == (*names, "sine")


@pytest.mark.parametrize("name", scenario_names())
def test_a_built_in_scenario_survives_being_written_and_read(name: str, tmp_path: Path) -> None:
    scenario = load_scenario(name)
    path = tmp_path / "again.toml"
    path.write_text(dump_scenario(scenario))
    assert load_scenario(path) == scenario
    assert scenario.name == name


@given(
    mass_kg=st.floats(LEAST_BOX_MASS_KG, MAX_BOX_MASS_KG),
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


@given(scale=st.floats(0.5, 1.0))
def test_of_the_robot_only_what_differs_is_written(scale: float, tmp_path_factory: pytest.TempPathFactory) -> None:
    plain = load_scenario("push")
    assert "robot" not in dump_scenario(plain)
    assert tomllib.loads(dump_scenario(plain, whole_robot=True))["robot"].keys() == set(ROBOT.__struct_fields__)
    lying = replace(ROBOT, fall=FallLimits(tilt_deg=45.0))
    assert tomllib.loads(dump_scenario(replace(plain, robot=lying)))["robot"] == {"fall": {"tilt_deg": 45.0}}
    scenario = replace(plain, robot=scaled_robot(scale))
    path = tmp_path_factory.mktemp("robot") / "any.toml"
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
