"""Every command and every kind of cell refuses a world that does not know its episodes, before it writes anything."""

from pathlib import Path

import pytest

from agent_proc.programs import compare, evaluate, train, tune
from agent_proc.studies.push_cell import PushCell
from agent_proc.studies.push_cell import resolve as resolve_push
from agent_proc.studies.training_cell import resolve as resolve_training
from agent_proc.studies.training_settings import TrainingCell
from agent_proc.task.file import load_task
from agent_proc.task.worlds import of_training, require_known
from legpush.errors import ConfigError

PROGRAMS = {"train": train, "tune": tune, "compare": compare, "evaluate": evaluate}
MASS = ("--mass-kg", "0.1", "0.9")
REAL = "`realism` with"


@pytest.mark.parametrize("more", [(), ("--dry-run",), ("--seeds", "1,2"), ("--seeds", "1,2", "--dry-run")], ids=str)
@pytest.mark.parametrize(
    ("argv", "words", "instead"),
    [
        (("--world", "map", *MASS), "the box of the response map, mass_kg", "--world map_unknown or --world mujoco"),
        (("--world", "map_mean", "--friction", "0.2", "0.3"), "friction", "--world map_unknown or --world mujoco"),
        (("--world", "map", "--set", "box.mass_kg=0.7"), "mass_kg", "--world map_unknown or --world mujoco"),
        (("--world", "map", "--task", "push-l2"), "the box of the response map", "--world map_unknown or --world muj"),
        (("--world", "map", "--scenario", "default"), "without obstacles", "--world mujoco or --scenario open"),
        (("--world", "map_unknown", "--task", "push-l3"), REAL, "--world mujoco or --scenario open"),
        (("--world", "map", "--task", "push-l3"), "slope", "--world mujoco"),
    ],
    ids=str,
)
def test_trainings(
    argv: tuple[str, ...],
    more: tuple[str, ...],
    words: str,
    instead: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    told = refused("train", (*argv, *more), tmp_path, monkeypatch, capsys)
    assert words in told
    assert f"; give {instead}" in told


@pytest.mark.parametrize(
    ("command", "argv", "instead"),
    [
        ("tune", MASS, "--world map_unknown or --world mujoco"),
        ("tune", ("--task", "push-l3", "--world", "map_unknown"), "--world mujoco or --scenario open"),
        ("compare", ("scripted", "--world", "map", "--task", "push-l2"), "--world map_unknown or --world mujoco"),
        ("compare", ("scripted", "--world", "map", "--task", "push-l3"), "--world mujoco"),
        ("compare", ("scripted", "--world", "map_unknown", "--task", "push-l3"), "--world mujoco or --scenario open"),
        ("compare", ("scripted", "--task", "push-l2"), "--search-world map_unknown or --search-world mujoco"),
        ("compare", ("scripted", "--world", "map", "--sweep", "box.mass_kg=0.7"), "--world map_unknown or --world mu"),
        ("evaluate", ("scripted", "--world", "map", "--sweep", "box.mass_kg=0.1,0.9"), "--world map_unknown or --wo"),
        ("evaluate", ("scripted", "--world", "map_unknown", "--scenario", "open_real"), "--world mujoco or --scenario"),
    ],
)
def test_other_commands(
    command: str,
    argv: tuple[str, ...],
    instead: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert f"; give {instead}" in refused(command, argv, tmp_path, monkeypatch, capsys)


def refused(
    command: str,
    argv: tuple[str, ...],
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> str:
    """The one line with which a command ends; it has written nothing."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr("sys.argv", [command, *argv, "--out", "out"])
    assert PROGRAMS[command].main() == 2
    told = capsys.readouterr()
    assert told.err.count("\n") == 1
    assert told.err.startswith("error: Expected a world that knows these episodes for ")
    assert told.out == ""
    assert list(folder.iterdir()) == []
    return told.err


def test_cells() -> None:
    with pytest.raises(ConfigError, match=r"; give world map_unknown or world mujoco$"):
        resolve_training(TrainingCell(world="map", mass_kg=(0.1, 0.2)), ())
    with pytest.raises(ConfigError, match=r"; give world mujoco or scenario open$"):
        resolve_training(TrainingCell(world="map_unknown", task="push-l3"), ())
    with pytest.raises(ConfigError, match=r"for final_world, .*; give final_world mujoco or final_scenario open$"):
        resolve_training(TrainingCell(world="map", final_episodes=1, final_scenario="default"), ())
    with pytest.raises(ConfigError, match=r"; give world map_unknown or world mujoco$"):
        resolve_push(PushCell(world="map", domain="push-l2"), ())


def test_a_domain_that_draws_what_the_world_knows_is_taken() -> None:
    mass_kg = load_task("tuned").scenario.box.mass_kg
    task = load_task("tuned", domain={"mass_kg": (mass_kg, mass_kg)})
    require_known("map", lambda _: of_training(task))
    with pytest.raises(ConfigError, match="mass_kg"):
        require_known("map", lambda _: of_training(load_task("tuned", domain={"mass_kg": (mass_kg, 2 * mass_kg)})))
