"""`legpush calibrate`: the map that it writes, and what it says."""

import io
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.programs.calibrate import run
from agent_proc.push_model.map import load_push_map
from agent_proc.push_model.model import NOMINAL
from legpush.errors import ConfigError, StopRequestedError
from legpush.options.learning import CalibrateOptions


@pytest.fixture
def options(tmp_path: Path) -> CalibrateOptions:
    return CalibrateOptions(
        simulators=2, depths_m=(0.02, 0.05), series=1, box_mass_kg=0.7, out=tmp_path / "push_map.json"
    )


@pytest.mark.usefixtures("stop")
def test_it_writes_the_map_and_shows_it(options: CalibrateOptions) -> None:
    console = Console(file=io.StringIO(), width=200)

    assert run(options, console) == 0
    push_map = load_push_map(options.out, NOMINAL)
    assert (push_map.box.mass_kg, len(push_map.effects)) == (0.7, 8)
    said = console.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert " ".join(said[0].split()) == "face leg w1 = w2 depth [cm] forward [cm] left [cm] turn [deg] n"
    assert " ".join(said[1].split()) == "rear FL 0.5 2 1.35 ± 0.00 -0.33 ± 0.00 -1.43 ± 0.00 4"
    assert said[-3].startswith("rear face, one foot: turns on a radius of 0.")
    assert said[-1] == f"written to {options.out}"


@pytest.mark.usefixtures("stop")
def test_a_file_is_not_overwritten(options: CalibrateOptions, tmp_path: Path) -> None:
    options.out.write_text("mine")

    for out in (options.out, tmp_path / "none" / "map.json"):
        with pytest.raises(ConfigError, match="a new file in an existing folder for --out"):
            run(replace(options, out=out), Console(file=io.StringIO()))
    assert options.out.read_text() == "mine"


def test_an_interrupted_calibration_writes_nothing(options: CalibrateOptions, stop: threading.Event) -> None:
    stop.set()

    with pytest.raises(StopRequestedError, match="interrupted: nothing was written"):
        run(options, Console(file=io.StringIO()))
    assert not options.out.exists()
