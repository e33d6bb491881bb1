"""A recording of the scripted policy, which several tests forge."""

from pathlib import Path

import pytest

from tests.system.missions import do_mission, once


@pytest.fixture(scope="session")
def scripted_mission(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Path:
    """A folder with the run in `run` and its recording in `mission.mcap`; tests leave them as they are."""
    own = tmp_path_factory.getbasetemp()

    def make(folder: Path) -> None:
        flags = ("push", "--policy", "scripted", "--no-picture")
        do_mission(folder / "run", *flags, "--record", str(folder / "mission.mcap"))

    return once((own if worker_id == "master" else own.parent) / "scripted-mission", make)
