"""Folders of runs and trainings from elsewhere: nothing is written through a link in them."""

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from agent_proc.mission.process import writable_folder
from legpush.cli import command as cli
from legpush.errors import ConfigError
from legpush.history.journal import Journal
from legpush.runs.folder import LOGS, own_folder, require_no_links, run_folder
from legpush.scenarios.file import dump_scenario, load_scenario
from sim_proc.render.program import VideoConfig, film_run
from tests.legpush.fakes import opened

PLACES = (
    *("report.json.part", "mission.png", "mission.mp4", "episode-0000.journal", "checkpoint.part", "tensorboard"),
    *(LOGS, f"{LOGS}/agent.log", f"{LOGS}/command.txt.part", "best/card.json"),
)
USES: dict[str, Callable[[Path], object]] = {
    "run": lambda folder: run_folder(folder, load_scenario("push"), private=True).__enter__(),
    "train and recover": lambda folder: own_folder(folder).__enter__(),
    "agent": partial(writable_folder, private=True),
    "film": lambda folder: film_run(VideoConfig(folder=folder)),
}


@pytest.fixture
def victim(tmp_path: Path) -> Path:
    """A file of the user, outside of the folder."""
    path = tmp_path / ".bashrc"
    path.write_text("mine")
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The folder of an interrupted run."""
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "scenario.toml").write_text(dump_scenario(load_scenario("push")))
    with Journal(folder / "episode-0001.journal", opened()):
        pass
    return folder


@pytest.mark.parametrize("use", USES.values(), ids=USES)
@pytest.mark.parametrize("place", PLACES)
def test_a_folder_with_a_link_in_it_is_refused(
    folder: Path, victim: Path, place: str, use: Callable[[Path], object]
) -> None:
    (folder / place).parent.mkdir(exist_ok=True)
    (folder / place).symlink_to(victim)

    with pytest.raises(ConfigError, match=f"{place}: expected files and folders alone in the folder of a run"):
        use(folder)
    assert victim.read_text() == "mine"


def test_a_link_to_a_folder_and_one_to_nothing_are_refused_as_well(folder: Path, tmp_path: Path) -> None:
    for target in (tmp_path, tmp_path / "nothing"):
        link = folder / "logs"
        link.symlink_to(target)
        with pytest.raises(ConfigError, match="logs: expected files and folders"):
            require_no_links(folder)
        link.unlink()
    require_no_links(folder)


def test_a_pipe_is_refused(folder: Path) -> None:
    os.mkfifo(folder / "report.json.part")
    with pytest.raises(ConfigError, match=r"report\.json\.part"):
        require_no_links(folder)


def test_the_folder_itself_may_be_reached_by_a_link(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "here").symlink_to(folder)
    require_no_links(tmp_path / "here")


def test_the_command_says_so(folder: Path, victim: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / LOGS).mkdir()
    (folder / LOGS / "agent.log").symlink_to(victim)
    assert cli.main(["run", str(folder / "scenario.toml"), "--out", str(folder)]) == 2
    assert "agent.log: expected files and folders alone" in capsys.readouterr().err
    assert victim.read_text() == "mine"


def test_a_link_that_stays_in_the_folder_is_harmless(folder: Path) -> None:
    (folder / "newest.journal").symlink_to("episode-0001.journal")
    require_no_links(folder)
