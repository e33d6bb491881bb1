"""The `legpush` command, as a user calls it."""

import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

from legpush.cli import command as cli
from legpush.options.run import RunOptions
from legpush.scenarios.file import load_scenario, scenario_names

HEAVY = (
    "numpy",
    "zenoh",
    "mujoco",
    "ompl",
    "torch",
    "matplotlib",
    "mcap",
    "PIL",
    "yaml",
    "rich.live",
    "legpush.bus.bus",
)


def legpush(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    code = "import sys; from legpush.cli import main; sys.exit(main())"
    return subprocess.run(
        [sys.executable, "-P", "-c", code, *arguments], capture_output=True, text=True, check=False, cwd=cwd
    )


def test_help_names_the_subcommands() -> None:
    result = legpush("--help")
    assert result.returncode == 0
    for name in (
        "run",
        "scenarios",
        "map",
        "policy",
        "render",
        "record",
        "info",
        "recover",
        "replay",
        "branch",
        "export",
    ):
        assert f"• {name}" in result.stdout


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys; from legpush.cli import main\n"
        "try: main(['run', '--help'])\n"
        f"except SystemExit: print([name for name in {HEAVY!r} if name in sys.modules])"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.splitlines()[-1] == "[]"


def test_the_version_is_that_of_the_package() -> None:
    result = legpush("--version")
    assert (result.returncode, result.stdout) == (0, f"legpush {version('legpush')}\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["rum"], "error: Expected a command (run, train, evaluate, "),
        (["rum"], "got `rum` (did you mean `run`?)"),
        (["scenarios", "shw"], "got `shw` (did you mean `show`?)"),
        (["run", "--sed", "3"], "Unrecognized options: --sed, 3"),
        (["run", "--seed", "three"], "three"),
        (["run", "--seed", "-1"], "error: Expected a seed from 0 to 4294967295 for --seed, got -1\n"),
        (["run", "--planner", "prm"], "prm"),
        (["train", "--simulators", "0"], "Expected 1 to 256 for --simulators, got 0"),
        (["train", "--seed", "-1"], "for --seed, got -1"),
        (["evaluate", "scripted", "--episodes", "0"], "Expected 1 to 9007199254740992 for --episodes, got 0"),
        (["evaluate"], "POLICY"),
        (["calibrate", "--series", "0"], "Expected 1 to 9007199254740992 for --series, got 0"),
        (["calibrate", "--depths-m", "0.3"], "at most 0.25 m for --depths-m, got (0.3,)"),
        (["calibrate", "--curves", "1.5"], "values in [0, 1] for --curves, got (1.5,)"),
        (
            ["calibrate", "--out", "full/file"],
            "error: Expected a new file in an existing folder for --out, got full/file",
        ),
        (["run", "nope"], "error: Expected the name of a scenario (blocked_way, default, dubins_loop, "),
        (["run", "./nope.toml"], "error: nope.toml: expected a readable scenario file"),
        (
            ["run", "--set", "box.mass_kg=-1"],
            "error: --set: at `box.mass_kg`: expected a number from 0.001 to 1000, got -1\n",
        ),
        (["run", "--record", "no-such-folder/a.mcap"], "error: Expected a new file in an existing folder for --record"),
        (["record"], "FILE"),
        (
            ["record", "no-such-folder/a.mcap"],
            "error: Expected a file in an existing folder for FILE, got no-such-folder/a.mcap",
        ),
        (["record", "a.mcap", "--split-mb", "0"], "error: Expected 0.001 to 1e+06 for --split-mb, got 0.0"),
        (["record", "a.mcap", "--about", "x"], "error: Expected NAME=VALUE for --about, got 'x'"),
        (["info", "no-such.mcap"], "error: no-such.mcap: expected a recording that can be read"),
        (["recover", "no-such.mcap"], "error: no-such.mcap: expected a recording that can be read"),
        (["replay"], "error: Expected the file of a recording, got none"),
        (["replay", "a.mcap", "--verify", "--as", "sim"], "error: Expected either --verify or --as, got both"),
        (["replay", "a.mcap", "--policy", "x:y"], "error: Expected --as planner or --as sim with --policy"),
        (["run", "--policy", "a.zip"], "error: a.zip: expected --trust-policy-file"),
        (["replay", "a.mcap", "--rate", "0"], "error: Expected 0.001 to 1e+06 for --rate, got 0.0"),
        (["replay", "a.mcap", "--as", "cook"], "cook"),
        (
            ["export", "a.mcap"],
            "error: Expected --to with one of foxglove, csv, parquet, mp4, gif, urdf, html, or --out with its",
        ),
        (["export", "no-such.mcap", "--to", "csv"], "error: no-such.mcap: expected a recording that can be read"),
        (["branch", "a.mcap"], "error: Expected EPISODE:STEP for --at, such as 0:12, got ''"),
        (
            ["run", "--set", "box.mass_kg"],
            "error: Expected FIELD=VALUE for --set, such as box.mass_kg=0.9, got 'box",
        ),
        (["run", "--set", "box.mas=1"], "error: --set: at `box.mas`: unknown field (did you mean `mass_kg`?)"),
        (
            ["branch", "a.mcap", "--at", "0:3", "--set", "box.friction=0"],
            "error: Expected 1e-05 to 10 for --set box.fri",
        ),
        (
            ["branch", "a.mcap", "--at", "0:3", "--set", "room.slope_deg=1"],
            "Expected one of box.mass_kg, box.friction, ",
        ),
        (["branch", "no-such.mcap", "--at", "0:3"], "error: no-such.mcap: expected a recording that can be read"),
        (["train", "--join", "r", "--record", "a.mcap"], "error: Expected either --join or --record, got both"),
        (["run", "--inject-faults", "2"], "error: Expected a probability in [0, 1) for --inject-faults, got 2.0\n"),
        (
            ["run", "--planner-command", "no-such-planner"],
            "begins with a program, got 'no-such-planner', which is not one",
        ),
        (
            ["run", "--planner-command", "'"],
            'Expected a command for --planner-command, got "\'" (No closing quotation)',
        ),
        (["run", "push", "--out", "full"], "error: full: expected a new or empty folder"),
        (["scenarios", "show", "defalt"], "(did you mean `default`?)"),
        (["scenarios", "copy", "default", "full/file"], "error: full/file: expected a new file"),
        (
            ["map", "map.pgm"],
            "error: map.pgm: expected a map with its scale; for an image, name its .yaml or",
        ),
        (["map", "map.csv", "--cell-m", "1"], "map.csv: expected --cell-m and --first-row, which a .csv file"),
        (["map", "map.npy", "--first-row", "top"], "map.npy: expected --cell-m and --first-row, which a .npy"),
        (["map", "map.yaml", "--cell-m", "1"], "map.yaml: expected --cell-m only with .csv and .npy files\n"),
        (["map", "push", "--first-row", "top"], "push: expected --first-row only with .csv and .npy files\n"),
        (
            ["map", "map.csv", "--first-row", "top", "--cell-m", "0"],
            "0.001 to 100 for --cell-m, got 0.0\n",
        ),
        (
            ["map", "push", "--out", "no/map.png"],
            "in an existing folder for --out, got no/map.png",
        ),
        (["map", "push", "--out", "map.jpg"], "Expected a file that ends in .png, .svg, .pdf for --out, got map.jpg"),
        (["map", "map.yaml"], "error: map.yaml: expected a readable map file (No such file or directory)\n"),
        (["map", "defalt"], "(did you mean `default`?)"),
        (["render", "full"], "error: Expected the folder of a run, with an episode-*.journal in it, got full\n"),
    ],
)
def test_bad_input_ends_with_2_and_one_message(arguments: list[str], words: str, tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").touch()
    result = legpush(*arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert words in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["full"]


def test_scenarios_are_listed_with_what_they_are() -> None:
    lines = legpush("scenarios", "list").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(scenario_names())
    assert all(load_scenario(line.split()[0]).description in line for line in lines)


def test_a_shown_scenario_is_a_scenario_file(tmp_path: Path) -> None:
    path = tmp_path / "shown.toml"
    path.write_text(legpush("scenarios", "show", "published").stdout)
    assert load_scenario(path) == load_scenario("published")


def test_a_copied_scenario_can_be_shown(tmp_path: Path) -> None:
    copied = legpush("scenarios", "copy", "published", "mine.toml", cwd=tmp_path)
    assert copied.stdout == "wrote mine.toml\nwrote published_map.csv\n"
    assert legpush("scenarios", "show", "mine.toml", cwd=tmp_path).returncode == 0


def test_a_map_is_drawn_into_a_picture(tmp_path: Path) -> None:
    drawn = legpush("map", "published", cwd=tmp_path)
    assert drawn.returncode == 0, drawn.stderr
    assert drawn.stdout.splitlines() == [
        "size        60 x 60 m",
        "cells       600 x 600 of 0.1 m",
        "origin      (0, 0) is the lower left corner, x to the right, y up",
        "occupied    11.2% of the cells, in 10 rectangles",
        "wrote published_map.png",
    ]
    assert (tmp_path / "published_map.png").read_bytes().startswith(b"\x89PNG")


def test_run_takes_its_options_from_the_command_line(monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[RunOptions] = []

    def run_mission(options: RunOptions, console: object) -> int:
        taken.append(options)
        return 1

    monkeypatch.setattr("legpush.launch.run.launch_mission", run_mission)
    words = "run push --seed 3 --out here --planner rrt --set box.mass_kg=0.9 --no-video --deadline 60"
    assert cli.main([*words.split(), "--inject-faults", "0.2"]) == 1
    assert cli.main(["run"]) == 1
    assert taken == [
        RunOptions(
            scenario="push",
            seed=3,
            out=Path("here"),
            planner="rrt",
            changes=("box.mass_kg=0.9",),
            video=False,
            deadline_s=60.0,
            inject_faults=0.2,
        ),
        RunOptions(),
    ]


def test_render_becomes_the_film_process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    became: list[tuple[str, ...]] = []
    monkeypatch.setattr(os, "execv", lambda program, argv: became.append((program, *argv)))
    monkeypatch.setattr("legpush.cli.execute.hold", lambda: None)
    (tmp_path / "episode-0000.journal").touch()
    cli.main(["render", str(tmp_path)])
    cli.main(["render", str(tmp_path), "--camera", "top"])
    film = (sys.executable, sys.executable, "-P", "-m", "sim_proc.render", str(tmp_path))
    assert became == [film, (*film, "--camera", "top")]
