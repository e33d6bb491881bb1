"""Missions that several files look at. Each is run once per test run, by the process that needs it first; tests leave
their files as they are.
"""

import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

from legpush.scenarios.changes import override
from legpush.scenarios.file import dump_scenario, load_scenario
from tests.system.commands import STUDY_FILE
from tests.system.missions import LEGPUSH, LIMIT_S, do_mission, once

SEED = 4711


@dataclass(frozen=True)
class RecordedMission:
    """A mission and its recording."""

    out: Path
    """The folder of the run."""
    file: Path


@dataclass(frozen=True)
class ThoroughMission:
    """The default mission with a planner that thinks long enough to be killed meanwhile."""

    out: Path
    """The folder of the run."""
    scenario: Path

    @property
    def flags(self) -> tuple[str, ...]:
        """What does it again."""
        return (str(self.scenario), "--seed", str(SEED))


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Path:
    """A folder that all processes of this test run share."""
    own = tmp_path_factory.getbasetemp()
    return own if worker_id == "master" else own.parent


@pytest.fixture(scope="session")
def push_mission(shared: Path) -> RecordedMission:
    """The shortest mission, recorded."""

    def make(folder: Path) -> None:
        do_mission(folder / "run", "push", "--record", str(folder / "mission.mcap"))

    folder = once(shared / "push-mission", make)
    return RecordedMission(folder / "run", folder / "mission.mcap")


@pytest.fixture(scope="session")
def short_study(shared: Path) -> Path:
    """The folder of a study of eight episodes of pushes."""

    def make(folder: Path) -> None:
        (folder / "study.toml").write_text(STUDY_FILE)
        words = ("study", "run", str(folder / "study.toml"), "--out", str(folder / "study"), "--workers", "1")
        subprocess.run([*LEGPUSH, *words], check=True, timeout=LIMIT_S)

    return once(shared / "short-study", make) / "study"


@pytest.fixture(scope="session")
def thorough_mission(shared: Path) -> ThoroughMission:
    """A whole mission, to which nothing happened."""

    def mission(folder: Path) -> ThoroughMission:
        return ThoroughMission(folder / "run", folder / "thorough.toml")

    def make(folder: Path) -> None:
        made = mission(folder)
        changes = {"planning.planner": "rrt_star", "planning.max_iterations": 8_000}
        made.scenario.write_text(dump_scenario(override(load_scenario("default"), changes)))
        do_mission(made.out, *made.flags)

    return mission(once(shared / "thorough-mission", make))
