"""`legpush calibrate` with real simulators, and missions with what it wrote."""

import subprocess
import sys
from pathlib import Path

import pytest

from agent_proc.push_model.map import load_push_map
from legpush.scenarios.file import load_scenario

LEGPUSH = str(Path(sys.executable).with_name("legpush"))


def legpush(*arguments: str, cwd: Path) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([LEGPUSH, *arguments], cwd=cwd, capture_output=True, text=True, check=False, timeout=240)


@pytest.fixture(scope="module")
def push_map(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The map of a heavy box with little friction, shortly measured."""
    folder = tmp_path_factory.mktemp("calibrate")
    options = ("--set", "box.mass_kg=0.9", "--set", "box.friction=0.3", "--depths-m", "0.03", "0.05", "--series", "1")
    done = legpush("calibrate", *options, "--simulators", "2", "--out", "map.json", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "rear face, one foot: turns on a radius of 0." in done.stdout
    assert "written to map.json" in done.stdout
    return folder / "map.json"


def test_a_map_says_what_the_simulated_box_does(push_map: Path) -> None:
    measured = load_push_map(push_map, load_scenario("default").box)

    assert (measured.box.mass_kg, measured.box.friction) == (0.9, 0.3)
    rear, right = measured.circles
    assert (rear.face, right.face) == ("rear", "right")
    low, high = rear.radius_m.ends
    assert 0.4 < low < rear.radius_m.value < high < 0.6
    assert (rear.radius_m.kind, rear.radius_m.n) == ("BCa bootstrap 95 %", 8)
    assert 0.6 < right.radius_m.value < 1.1
    assert 0.05 < rear.axle_m.value < 0.2
    assert all(effect.n == 4 for effect in measured.effects)
    assert measured.command.startswith("legpush calibrate --set box.mass_kg=0.9")


def test_a_mission_takes_the_map_and_refuses_that_of_another_box(push_map: Path) -> None:
    arguments = ("--no-video", "--policy", "scripted", "--push-map", push_map.name)

    assert legpush("run", "push", *arguments, "--out", "good", cwd=push_map.parent).returncode == 0
    legpush("scenarios", "copy", "push", "long.toml", cwd=push_map.parent)
    scenario = push_map.parent / "long.toml"
    scenario.write_text(scenario.read_text().replace("[0.4, 0.5, 0.4]", "[0.4, 0.48, 0.4]"))
    bad = legpush("run", "long.toml", *arguments, "--out", "bad", cwd=push_map.parent)

    assert bad.returncode == 2
    assert "expected the push map of a cuboid of 0.4 x 0.48 x 0.4 m, got that of a cuboid of 0.4 x 0.5" in bad.stderr
