"""Calibration as a program: `legpush calibrate`."""

import shlex
import sys
import threading
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path

import msgspec
import tyro
from rich.console import Console
from rich.table import Table
from rich.text import Text

from agent_proc.push_model.calibration import Cell, calibrate, cells
from agent_proc.push_model.map import PushMap, Sample, make_push_map, measured_faces, write_push_map
from agent_proc.simulators import simulators
from legpush.errors import StopRequestedError
from legpush.long_work.finished import open_finished
from legpush.long_work.progress import counted
from legpush.numerics.current import current
from legpush.options.checks import require_new_file
from legpush.options.learning import CalibrateOptions
from legpush.runs.temporary import temporary_folder
from legpush.scenarios.file import load_scenario, override
from legpush.scene.scenario import Scenario
from legpush.service import run_program, stop_on_signals


def main() -> int:
    """Parse the command line and measure; returns the exit code."""
    return run_program("calibrate", lambda: run(tyro.cli(CalibrateOptions, prog="legpush calibrate"), Console()))


def run(options: CalibrateOptions, console: Console) -> int:
    """Measure the pushes and write the map; returns the exit code.

    Raises:
        ConfigError: An option cannot be used.
        StopRequestedError: The user interrupted it; the finished series are kept.
    """
    scenario = _scenario(options)
    box = scenario.box
    require_new_file(options.out, "--out")
    curves = [(w, w) for w in options.curves]
    seeds = range(options.first_seed, options.first_seed + options.series)
    samples = _measure(options, scenario, cells(measured_faces(box), curves, options.depths_m, seeds), console)
    push_map = make_push_map(box, samples, shlex.join(["legpush", "calibrate", *sys.argv[1:]]))
    _show(push_map, console)
    write_push_map(push_map, options.out)
    unfinished(options.out).unlink()
    console.print(Text(f"written to {options.out}"), soft_wrap=True)
    return 0


def unfinished(out: Path) -> Path:
    """The file of the finished series while the map is not finished."""
    return out.with_name(f"{out.name}.unfinished")


def _measure(options: CalibrateOptions, scenario: Scenario, planned: list[Cell], console: Console) -> list[Sample]:
    """Push the series that are not finished yet; returns the samples of all.

    Raises:
        StopRequestedError: The user interrupted it; the finished series are kept.
    """
    stop, links_stop = stop_on_signals(), threading.Event()
    work = {
        "robot": msgspec.to_builtins(scenario.robot),
        "box": msgspec.to_builtins(scenario.box),
        "legpush": version("legpush"),
        "numerics": current().name,
    }
    names = {_name(cell): cell for cell in planned}
    with open_finished(unfinished(options.out), work) as kept, temporary_folder("calibrate-") as logs:
        before = {
            names[name]: [Sample(**fields) for fields in samples]
            for name, samples in kept.parts.items()
            if name in names
        }
        if before:
            console.print(Text(f"{len(before)} of {len(planned)} series are finished already"), soft_wrap=True)
        with (
            counted(console, "pushing", len(planned), "series", done=len(before)) as advance,
            simulators(options, logs, links_stop, kind="calibrate") as worlds,
        ):

            def on_cell(cell: Cell, samples: Sequence[Sample]) -> None:
                kept.keep(_name(cell), [asdict(sample) for sample in samples])
                advance()

            try:
                return calibrate(
                    worlds, scenario.robot, scenario.box, planned, on_cell=on_cell, stop=stop, finished=before
                )
            except StopRequestedError as error:
                if not kept.parts:
                    raise StopRequestedError("interrupted: no series was finished") from error
                raise StopRequestedError(
                    f"interrupted: {len(kept.parts)} of {len(planned)} series are kept in {kept.path}; the same "
                    "command goes on"
                ) from error
            finally:
                links_stop.set()


def _name(cell: Cell) -> str:
    return f"{cell.face} face, w {cell.curve[0]!r}, {cell.depth_m!r} m, seed {cell.seed}"


def _scenario(options: CalibrateOptions) -> Scenario:
    changes = {
        "box.mass_kg": options.box_mass_kg,
        "box.friction": options.box_friction,
        "box.foot_friction": options.box_foot_friction,
    }
    given = {field: value for field, value in changes.items() if value is not None}
    return override(load_scenario(options.scenario), given)


def _show(push_map: PushMap, console: Console) -> None:
    """Print mean and standard deviation of each effect, and the circles."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for title in ("face", "leg", "w1 = w2", "depth [cm]", "forward [cm]", "left [cm]", "turn [deg]", "n"):
        table.add_column(Text(title), justify="left" if title in ("face", "leg") else "right", no_wrap=True)
    for e in push_map.effects:
        table.add_row(
            e.face,
            e.leg,
            f"{e.w1:g}",
            f"{100 * e.depth_m:g}",
            f"{100 * e.forward_m:.2f} ± {100 * e.forward_sd_m:.2f}",
            f"{100 * e.left_m:+.2f} ± {100 * e.left_sd_m:.2f}",
            f"{e.turn_deg:+.2f} ± {e.turn_sd_deg:.2f}",
            str(e.n),
        )
    console.print(table)
    for circle in push_map.circles:
        console.print(
            Text(
                f"{circle.face} face, one foot: turns on a radius of {circle.radius_m.text('.3f')} m about a point "
                f"beside one {circle.axle_m.text('.3f')} m behind the centre"
            ),
            soft_wrap=True,
        )
