"""Calibration as a program: `legpush calibrate`."""

import shlex
import sys
import threading

import tyro
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from agent_proc.push_model.calibration import calibrate, cells
from agent_proc.push_model.map import PushMap, make_push_map, measured_faces, write_push_map
from agent_proc.simulators import simulators
from legpush.errors import ConfigError, StopRequestedError
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
        StopRequestedError: The user interrupted it; nothing is written.
    """
    scenario = _scenario(options)
    robot, box = scenario.robot, scenario.box
    if options.out.exists() or not options.out.parent.is_dir():
        raise ConfigError(f"Expected a new file in an existing folder for --out, got {options.out}")
    curves = [(w, w) for w in options.curves]
    seeds = range(options.first_seed, options.first_seed + options.series)
    planned = cells(measured_faces(box), curves, options.depths_m, seeds)
    stop, links_stop = stop_on_signals(), threading.Event()
    with temporary_folder("calibrate-") as logs, _bar(console) as bar:
        task = bar.add_task("pushing", total=len(planned))
        with simulators(options, logs, links_stop, kind="calibrate") as worlds:
            try:
                samples = calibrate(worlds, robot, box, planned, on_cell=lambda: bar.advance(task), stop=stop)
            except StopRequestedError as error:
                raise StopRequestedError("interrupted: nothing was written") from error
            finally:
                links_stop.set()
    push_map = make_push_map(box, samples, shlex.join(["legpush", "calibrate", *sys.argv[1:]]))
    write_push_map(push_map, options.out)
    _show(push_map, console)
    console.print(Text(f"written to {options.out}"), soft_wrap=True)
    return 0


def _scenario(options: CalibrateOptions) -> Scenario:
    changes = {"box.mass_kg": options.box_mass_kg, "box.friction": options.box_friction}
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


def _bar(console: Console) -> Progress:
    """A bar with the number of finished series and the remaining time."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, TimeRemainingColumn(), console=console, disable=not console.is_terminal)
