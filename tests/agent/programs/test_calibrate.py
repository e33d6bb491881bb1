"""`legpush calibrate`: the map that it writes, and what it says."""

import io
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.map_world.response_map import load_response_map
from agent_proc.programs import measure_parts
from agent_proc.programs.calibrate import run
from agent_proc.push_model.map import load_push_map
from agent_proc.push_model.model import NOMINAL
from legpush.errors import ConfigError, StopRequestedError
from legpush.options.learning import CalibrateOptions
from legpush.scenarios.changes import change_fields
from legpush.scenarios.file import dump_scenario, load_scenario
from tests.agent.programs.conftest import stopping


@pytest.fixture
def options(tmp_path: Path) -> CalibrateOptions:
    return CalibrateOptions(
        simulators=2, depths_m=(0.02, 0.05), series=1, changes=("box.mass_kg=0.7",), out=tmp_path / "push_map.json"
    )


@pytest.mark.usefixtures("stop")
def test_it_writes_the_map_and_shows_it(options: CalibrateOptions) -> None:
    console = Console(file=io.StringIO(), width=200)

    assert run(options, console) == 0
    push_map = load_push_map(options.out, NOMINAL)
    assert (push_map.box.mass_kg, len(push_map.effects)) == (0.7, 8)
    said = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert said[0].endswith("pushing  4 of 4 series")
    assert " ".join(said[1].split()) == "face leg w1 = w2 depth [cm] forward [cm] left [cm] turn [deg] n"
    assert " ".join(said[2].split()) == "rear FL 0.5 2 1.35 ± 0.00 -0.33 ± 0.00 -1.43 ± 0.00 4"
    assert said[-3].startswith("rear face, one foot: turns on a radius of 0.")
    assert said[-1] == f"written to {options.out}"
    assert [path.name for path in options.out.parent.iterdir()] == [options.out.name]


@pytest.mark.usefixtures("stop")
def test_random_pushes_give_a_response_map(tmp_path: Path) -> None:
    options = CalibrateOptions(simulators=2, random_pushes=181, out=tmp_path / "map.json")
    console = Console(file=io.StringIO(), width=200)

    assert run(options, console) == 0
    response_map = load_response_map(options.out)
    assert [(surface.face, surface.quality.n) for surface in response_map.surfaces] == [("rear", 200), ("right", 200)]
    assert all(r_squared > 0.99 for surface in response_map.surfaces for r_squared in surface.quality.r_squared)
    said = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert said[0].endswith("pushing  20 of 20 series")
    assert " ".join(said[1].split()) == "face depth [cm] forward [mm] left [mm] turn [deg] n"
    assert said[-2].startswith("right face, 200 pushes, cross-validated: forward: R² 1.0000, error 0.0")
    assert [path.name for path in tmp_path.iterdir()] == ["map.json"]


@pytest.mark.usefixtures("stop")
def test_random_pushes_need_a_box_that_is_its_own_mirror_image(tmp_path: Path) -> None:
    scenario = tmp_path / "wedge.toml"
    plain = dump_scenario(change_fields(load_scenario("default"), {"box.shape": "wedge"}))
    scenario.write_text(plain, encoding="utf-8")
    options = CalibrateOptions(scenario=str(scenario), random_pushes=100, out=tmp_path / "map.json")

    with pytest.raises(
        ConfigError, match="Expected a box of the shape cuboid or cylinder for random pushes, got wedge"
    ):
        run(options, Console(file=io.StringIO()))
    with pytest.raises(ConfigError, match="Expected either --random-pushes or --depths-m, --curves and --series"):
        CalibrateOptions(random_pushes=100, curves=(0.2,))


@pytest.mark.usefixtures("stop")
def test_a_file_is_not_overwritten(options: CalibrateOptions, tmp_path: Path) -> None:
    options.out.write_text("mine")

    for out in (options.out, tmp_path / "none" / "map.json"):
        with pytest.raises(ConfigError, match="a new file in an existing folder for --out"):
            run(replace(options, out=out), Console(file=io.StringIO()))
    assert options.out.read_text() == "mine"


def test_a_calibration_that_is_interrupted_at_once_keeps_nothing(
    options: CalibrateOptions, stop: threading.Event
) -> None:
    stop.set()

    with pytest.raises(StopRequestedError, match="interrupted: no series was finished"):
        run(options, Console(file=io.StringIO()))
    assert list(options.out.parent.iterdir()) == []


@pytest.mark.parametrize("n_finished", [1, 3])
def test_an_interrupted_calibration_goes_on_to_the_map_of_an_undisturbed_one(
    n_finished: int,
    options: CalibrateOptions,
    stop: threading.Event,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    options = replace(options, simulators=1)
    assert run(replace(options, out=tmp_path / "whole.json"), Console(file=io.StringIO())) == 0
    with monkeypatch.context() as patch:
        patch.setattr(measure_parts, "simulators", stopping(stop, n_finished))
        words = (
            rf"interrupted: {n_finished} of 4 series are kept in .*push_map\.json\.unfinished; the same command goes on"
        )
        with pytest.raises(StopRequestedError, match=words):
            run(options, Console(file=io.StringIO()))
    stop.clear()
    with pytest.raises(ConfigError, match="got some with another box; remove the file to begin again"):
        run(replace(options, changes=("box.mass_kg=0.5",)), Console(file=io.StringIO()))

    console = Console(file=io.StringIO(), width=200)
    assert run(options, console) == 0
    assert console.file.getvalue().startswith(f"{n_finished} of 4 series are finished already\n")  # type: ignore[attr-defined]
    assert options.out.read_bytes() == (tmp_path / "whole.json").read_bytes()
    assert {path.name for path in tmp_path.iterdir()} == {"whole.json", "push_map.json"}
