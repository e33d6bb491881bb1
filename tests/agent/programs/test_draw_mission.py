"""`legpush picture`: a mission is drawn again in any format, and what is no run is refused."""

import json
import threading
from pathlib import Path

import pytest

from agent_proc.mission.process import AgentConfig, work
from agent_proc.programs.draw_mission import run
from legpush.errors import ConfigError
from legpush.options.maps import PictureOptions
from legpush.runs.folder import journals
from legpush.scenarios.file import dump_scenario
from tests.agent.fake_world import KinematicSimulator, make_scenario, straight_plan
from tests.legpush.fakes import bus, planner, sim

HEADS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a mission in a world without physics."""
    folder = tmp_path_factory.mktemp("m")
    sockets, scenario, out = folder / "s", folder / "fake.toml", folder / "out"
    sockets.mkdir(mode=0o700)
    scenario.write_text(dump_scenario(make_scenario()), encoding="utf-8")
    with (
        sim(sockets, KinematicSimulator()),
        planner(sockets, straight_plan),
        bus(sockets, "agent") as opened,
    ):
        assert work(AgentConfig(scenario=str(scenario), out=out), opened, threading.Event()) == 0
    return out


@pytest.mark.parametrize("ending", HEADS)
def test_a_mission_is_drawn_again_in_any_format(
    ending: str, mission: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [tmp_path / f"{name}{ending}" for name in "ab"]
    for file in files:
        assert run(PictureOptions(run_folder=mission, out=file)) == 0

    a, b = (file.read_bytes() for file in files)
    assert a.startswith(HEADS[ending])
    assert a == b
    assert f"wrote {files[0]}" in capsys.readouterr().out


def test_the_picture_of_the_run_is_drawn_again(mission: Path, tmp_path: Path) -> None:
    run(PictureOptions(run_folder=mission, out=tmp_path / "again.png"))
    assert (tmp_path / "again.png").read_bytes() == (mission / "mission.png").read_bytes()


def test_it_is_a_vector_file_beside_the_journal_if_nothing_else_is_asked_for(mission: Path) -> None:
    assert PictureOptions(run_folder=mission).target() == mission / "mission.svg"


def test_what_cannot_be_drawn_is_refused(mission: Path, tmp_path: Path) -> None:
    for ending in (".jpg", ""):
        with pytest.raises(ConfigError, match=r"Expected a file that ends in \.png, \.svg, \.pdf for --out, got"):
            PictureOptions(run_folder=mission, out=tmp_path / f"a{ending}")
    with pytest.raises(ConfigError, match="Expected the folder of a run for DIR, got"):
        PictureOptions(run_folder=tmp_path / "nothing")
    with pytest.raises(ConfigError, match="Expected a new file in an existing folder for --out"):
        PictureOptions(run_folder=mission, out=mission / "mission.png")
    with pytest.raises(ConfigError, match="expected the journal of one mission, got 0"):
        run(PictureOptions(run_folder=tmp_path))
    (journal,) = journals(mission)
    (tmp_path / journal.name).write_bytes(journal.read_bytes())
    (tmp_path / "report.json").write_text(json.dumps({"success": True}))
    with pytest.raises(ConfigError, match=r"expected a report with success, reason, .* got none of reason"):
        run(PictureOptions(run_folder=tmp_path))
