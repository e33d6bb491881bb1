"""The launcher's folder, display, summary and options."""

import json
import re
import stat
import sys
from datetime import datetime
from io import StringIO
from pathlib import Path

import msgspec
import pytest
from rich.console import Console

from legpush.errors import ConfigError, ScenarioError
from legpush.fields import Name
from legpush.launch.display import LiveDisplay, PlainDisplay, make_display
from legpush.launch.mission_recorder import next_file
from legpush.launch.process_commands import Place, bus_flags, process_arguments
from legpush.launch.run import resolve_scenario
from legpush.launch.summary import ROWS, ReportError, print_summary, read_report
from legpush.options.run import RunOptions
from legpush.processes.child import describe_exit
from legpush.processes.environment import child_environment
from legpush.runs.folder import default_folder, run_folder
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario("push")


# -- folder ----------------------------------------------------------------------------------------------------------


def test_the_default_folder_says_when_what_and_with_which_seed(scenario: Scenario) -> None:
    assert default_folder(scenario, 7, datetime(2026, 3, 4, 5, 6, 7)) == Path("runs/20260304-050607-push-seed7")


def test_a_run_folder_holds_the_resolved_scenario_and_a_place_for_logs(scenario: Scenario, tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "run"
    with run_folder(folder, scenario):
        assert load_scenario(folder / "scenario.toml") == scenario
        assert (folder / "logs").is_dir()


def test_an_empty_folder_may_be_used(scenario: Scenario, tmp_path: Path) -> None:
    with run_folder(tmp_path, scenario):
        assert (tmp_path / "scenario.toml").exists()


def test_the_folder_of_the_same_run_may_be_used_again(scenario: Scenario, tmp_path: Path) -> None:
    with run_folder(tmp_path, scenario):
        (tmp_path / "episode.journal").write_text("so far")
    with run_folder(tmp_path, scenario):
        assert (tmp_path / "episode.journal").read_text() == "so far"


def test_the_folder_of_a_run_of_another_scenario_is_refused_and_left_alone(scenario: Scenario, tmp_path: Path) -> None:
    with run_folder(tmp_path, scenario):
        pass
    other = msgspec.structs.replace(scenario, name="other")
    with (
        pytest.raises(ConfigError, match="expected a new folder, got that of a run of another scenario"),
        run_folder(tmp_path, other),
    ):
        pass
    assert load_scenario(tmp_path / "scenario.toml") == scenario


def test_a_folder_with_other_files_is_refused_and_left_alone(scenario: Scenario, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(ConfigError, match="got one with other files"), run_folder(tmp_path, scenario):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_file_in_the_place_of_the_folder_is_refused(scenario: Scenario, tmp_path: Path) -> None:
    (tmp_path / "run").touch()
    with (
        pytest.raises(ConfigError, match=r"run: expected a folder that can be written to \(File exists\)"),
        run_folder(tmp_path / "run", scenario),
    ):
        pass


def test_two_launchers_never_share_a_folder(scenario: Scenario, tmp_path: Path) -> None:
    with (
        run_folder(tmp_path, scenario),
        pytest.raises(ConfigError, match="another launcher is running in it"),
        run_folder(tmp_path, scenario),
    ):
        pass


# -- display ---------------------------------------------------------------------------------------------------------


def plain_lines(console: Console) -> list[str]:
    """What was printed, without the times."""
    assert isinstance(console.file, StringIO)
    return [re.sub(r"^ *[0-9.]+ s  ", "", line) for line in console.file.getvalue().splitlines()]


def test_a_terminal_gets_a_live_display_anything_else_plain_lines() -> None:
    assert isinstance(make_display(Console(file=StringIO(), force_terminal=True)), LiveDisplay)
    assert isinstance(make_display(Console(file=StringIO(), force_terminal=False)), PlainDisplay)


def test_plain_lines_come_with_each_phase_each_tenth_and_each_wait() -> None:
    console = Console(file=StringIO(), width=40)
    with PlainDisplay(console, clock=lambda: 0.0) as display:
        for percent in range(100):
            display.progress("walking", percent / 100, f"{percent} cm", "")
        display.progress("pushing", None, "cycle 1", "")
        display.progress("pushing", None, "cycle 2", "")
        display.progress("pushing", None, "cycle 2", "sim (dead)")
        display.notice("the sim died [of old age]; a line that is longer than the console")
    walking = [f"walking  {percent:3d}%  {percent} cm" for percent in range(0, 100, 10)]
    assert [re.sub(" +", " ", line) for line in plain_lines(console)] == [
        *(re.sub(" +", " ", line) for line in walking),
        "pushing cycle 1",
        "pushing cycle 2 waiting for sim (dead)",
        "the sim died [of old age]; a line that is longer than the console",
    ]


def test_a_long_phase_gets_a_plain_line_every_few_seconds_if_something_changed() -> None:
    console = Console(file=StringIO())
    now = 0.0
    with PlainDisplay(console, clock=lambda: now) as display:
        for cycle in range(60):
            now = 0.5 * cycle
            display.progress("pushing", None, f"cycle {cycle}", "")
        for _ in range(60):
            now += 0.5
            display.progress("pushing", None, "cycle 59", "")
    assert plain_lines(console) == [
        *(f"pushing  cycle {cycle}" for cycle in (0, 10, 20, 30, 40, 50)),
        "pushing  cycle 59",
    ]


def test_the_live_display_shows_the_last_phase_and_keeps_notices() -> None:
    console = Console(file=StringIO(), force_terminal=True, color_system=None, width=120)
    with LiveDisplay(console) as display:
        display.progress("walking", 0.5, "4.0 of 8.0 m", "")
        display.notice("the planner died [sic]")
        display.progress("pushing", None, "cycle 3, 12 cm to go [m]", "sim (slow)")
    assert isinstance(console.file, StringIO)
    text = console.file.getvalue()
    assert "the planner died [sic]" in text
    assert "4.0 of 8.0 m" in text
    assert "cycle 3, 12 cm to go [m]" in text
    assert "waiting for sim (slow)" in text


# -- summary ---------------------------------------------------------------------------------------------------------

REPORT = {
    "success": True,
    "reason": "success",
    "detail": "the box is at its goal",
    "box_position_error_m": 0.0123,
    "box_angle_error_deg": 1.26,
    "walk_tracking_rms_m": None,
    "box_path_rms_m": 0.0084,
    "handover_distance_m": 0.95,
    "trunk_max_abs_pitch_deg": 1.5,
    "trunk_max_abs_roll_deg": 2.5,
    "min_support_margin_m": 0.031,
    "n_better_paths": 2,
    "n_replans": 1,
    "appeared": [{"obstacle": 3, "time_s": 12.0}],
    "n_push_cycles": 17,
    "n_footsteps": 240,
    "sim_time_s": 101.25,
    "wall_time_s": 7.5,
    "real_time_factor": 13.5,
    "state_crc": 123456789,
    "seed": 3,
    "recording": {"file": "mission.mcap", "complete": True, "notes": []},
    "versions": {"legpush": "0.1.0"},
}


def test_the_summary_tells_every_number_and_only_the_files_that_are_there(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text(json.dumps(REPORT))
    (tmp_path / "logs").mkdir()
    console = Console(file=StringIO(), width=200)
    print_summary(console, tmp_path, read_report(tmp_path))
    assert isinstance(console.file, StringIO)
    text = console.file.getvalue()
    for title, _ in ROWS.values():
        assert title in text
    for value in ("success", "1.2 cm", "1.3°", "-", "0.95 m", "3.1 cm", "17", "101.2 s", "13.5", "123456789"):
        assert value in text
    assert f"In {tmp_path}:\n  report.json" in text
    assert "  logs" in text
    assert "mission.mp4" not in text


@pytest.mark.parametrize(
    ("appeared", "shown"),
    [
        ([], False),
        ([{"obstacle": 7, "time_s": 6.0}, {"obstacle": 8, "time_s": 65.04}], True),
    ],
)
def test_the_summary_tells_what_appeared_if_anything_did(
    appeared: list[dict[str, float]], shown: bool, tmp_path: Path
) -> None:
    console = Console(file=StringIO(), width=200)
    print_summary(console, tmp_path, {**REPORT, "appeared": appeared, "n_replans": 2})
    assert isinstance(console.file, StringIO)
    text = console.file.getvalue()
    assert ("room.obstacles[7] at 6.0 s, room.obstacles[8] at 65.0 s" in text) == shown
    assert ("new paths because of them" in text) == shown


def test_the_table_shows_every_field_of_a_report_but_the_versions() -> None:
    assert {*ROWS, "versions"} == REPORT.keys()


@pytest.mark.parametrize(
    ("content", "words"), [(None, "No such file"), ("{", "Expecting"), ("[]", "JSON object, got list")]
)
def test_a_report_that_cannot_be_read_is_named(content: str | None, words: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "report.json").write_text(content)
    with pytest.raises(ReportError, match=rf"report\.json: expected .*{words}"):
        read_report(tmp_path)


# -- options and command lines ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"seed": -1}, "--seed, got -1"),
        ({"seed": 2**32}, "--seed, got 4294967296"),
        ({"inject_faults": 1.0}, "--inject-faults, got 1.0"),
        ({"inject_faults": float("nan")}, "--inject-faults, got nan"),
        ({"deadline_s": 0.0}, "--deadline, got 0.0"),
        ({"deadline_s": float("inf")}, "--deadline, got inf"),
    ],
)
def test_options_out_of_range_are_refused(options: dict[str, float], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        RunOptions(**options)  # type: ignore[arg-type]


def test_options_replace_what_the_scenario_says() -> None:
    options = RunOptions(scenario="push", planner="rrt_star", box_mass_kg=0.9, box_friction=0.3)
    scenario = resolve_scenario(options)
    assert (scenario.planning.planner, scenario.box.mass_kg, scenario.box.friction) == ("rrt_star", 0.9, 0.3)
    assert resolve_scenario(RunOptions(scenario="push")) == load_scenario("push")


def test_a_replaced_value_is_checked_as_in_a_file() -> None:
    with pytest.raises(ScenarioError, match=r"command line: at `box\.mass_kg`: expected a number >= 0\.001, got -1\.0"):
        resolve_scenario(RunOptions(scenario="push", box_mass_kg=-1.0))


@pytest.mark.parametrize("folder", ["run-1", "my run.5 (ü)", "x" * 100])
def test_the_run_is_named_after_its_folder(folder: str, tmp_path: Path) -> None:
    run = Place(folder=tmp_path / folder, sockets=tmp_path).run
    assert msgspec.convert(run, Name) == run
    assert run == Place(folder=tmp_path / folder, sockets=tmp_path / "other").run


def test_only_the_agent_gets_the_scenario(tmp_path: Path) -> None:
    place = Place(folder=tmp_path, sockets=tmp_path)
    options = RunOptions(seed=5)
    assert process_arguments("sim", options, place) == (sys.executable, "-P", "-m", "sim_proc")
    agent = " ".join(process_arguments("agent", options, place))
    assert f"--scenario {tmp_path}/scenario.toml --seed 5 --out {tmp_path} --policy variable" in agent


def test_processes_meet_at_sockets_in_a_private_directory(tmp_path: Path) -> None:
    sockets = tmp_path / "s"
    sockets.mkdir(mode=0o700)
    place = Place(folder=tmp_path / "run-1", sockets=sockets)
    sim = bus_flags("sim", RunOptions(), place)
    agent = bus_flags("agent", RunOptions(seed=3, inject_faults=0.2), place)
    listens = sim[sim.index("--listen") + 1]
    assert sim == ("--run", "run-1", "--listen", listens)
    assert listens in agent[agent.index("--connect") :]
    assert agent[-4:] == ("--inject-faults", "0.2", "--fault-seed", "3")
    assert stat.S_IMODE(sockets.stat().st_mode) == 0o700


def test_processes_use_one_thread_per_library_and_keep_the_rest_of_the_environment() -> None:
    environment = child_environment({"HOME": "/home/you", "OMP_NUM_THREADS": "8"})
    assert environment["HOME"] == "/home/you"
    assert environment["OMP_NUM_THREADS"] == environment["OPENBLAS_NUM_THREADS"] == "1"


@pytest.mark.parametrize(("code", "words"), [(3, "exited with 3"), (-9, "was killed by SIGKILL")])
def test_how_a_process_ended_is_said_in_words(code: int, words: str) -> None:
    assert describe_exit(code) == words


def test_what_goes_on_is_recorded_to_the_next_file_that_is_free(tmp_path: Path) -> None:
    file = tmp_path / "m.mcap"
    file.touch()
    assert next_file(file).name == "m-2.mcap"
    (tmp_path / "m-2.mcap").touch()
    assert next_file(file).name == "m-3.mcap"
    assert next_file(tmp_path / "m-2.mcap").name == "m-3.mcap"
    (tmp_path / "seed-7.mcap").touch()
    assert next_file(tmp_path / "seed-7.mcap").name == "seed-7-2.mcap"
