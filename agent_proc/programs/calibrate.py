"""Calibration as a program: `legpush calibrate`."""

import shlex
import sys
import threading
from functools import partial
from math import ceil

import msgspec
from rich.console import Console
from rich.text import Text

from agent_proc.map_world.random_pushes import PUSHES_PER_SERIES, MeasuredSeries, RandomSeries, measure_series
from agent_proc.map_world.response_map import make_response_map, require_symmetric, write_response_map
from agent_proc.programs.calibration_tables import show_push_map, show_response_map
from agent_proc.programs.measure_parts import measure_parts, unfinished
from agent_proc.push_model.calibration import Cell, cell_samples, cells
from agent_proc.push_model.map import Sample, make_push_map, measured_faces, write_push_map
from legpush.lockstep.world import SteppingWorld
from legpush.options.checks import require_new_file
from legpush.options.learning import CalibrateOptions
from legpush.options.scenarios import changed_scenario
from legpush.output.reply import document
from legpush.scenarios.file import dump_scenario
from legpush.scene.scenario import Scenario
from legpush.service import run_command
from legpush.versions import installed_versions


def main() -> int:
    """Parse the command line and measure; returns the exit code."""
    return run_command("calibrate", CalibrateOptions, lambda options: run(options, Console()))


def run(options: CalibrateOptions, console: Console) -> int:
    """Measure the pushes and write the map; returns the exit code.

    Raises:
        ConfigError: An option cannot be used.
        StopRequestedError: The user interrupted it; the finished series are kept.
    """
    scenario = changed_scenario(options.scenario, options.changes)
    require_new_file(options.out, "--out")
    if options.dry_run:
        console.print(Text(dump_scenario(scenario)), soft_wrap=True)
        document(scenario)
        return 0
    measure = _push_map if options.random_pushes is None else partial(_response_map, options.random_pushes)
    measure(options, scenario, shlex.join(["legpush", "calibrate", *sys.argv[1:]]), console)
    unfinished(options.out).unlink()
    console.print(Text(f"written to {options.out}"), soft_wrap=True)
    document({"file": options.out, **msgspec.json.decode(options.out.read_bytes())})
    return 0


def _push_map(options: CalibrateOptions, scenario: Scenario, command: str, console: Console) -> None:
    """Measure series of equal pushes, and write their push map."""
    robot, box = scenario.robot, scenario.box
    curves = [(w, w) for w in options.curves]
    seeds = range(options.seed, options.seed + options.series)
    planned = {_name(cell): cell for cell in cells(measured_faces(box), curves, options.depths_m, seeds)}

    def one(world: SteppingWorld, cell: Cell, stop: threading.Event) -> list[Sample]:
        return cell_samples(world, robot, box, cell, stop)

    found = measure_parts(options, scenario, planned, one, list[Sample], console)
    push_map = make_push_map(box, [sample for samples in found for sample in samples], command)
    show_push_map(push_map, console)
    write_push_map(push_map, options.out)


def _response_map(n_pushes: int, options: CalibrateOptions, scenario: Scenario, command: str, console: Console) -> None:
    """Measure random pushes, and write the response map fitted to them."""
    robot, box = scenario.robot, scenario.box
    require_symmetric(box)
    seeds = range(options.seed, options.seed + ceil(n_pushes / PUSHES_PER_SERIES))
    planned = {
        f"{face} face, random, seed {seed}": RandomSeries(face=face, seed=seed)
        for face in measured_faces(box)
        for seed in seeds
    }

    def one(world: SteppingWorld, series: RandomSeries, stop: threading.Event) -> MeasuredSeries:
        return measure_series(world, robot, box, series, stop)

    found = measure_parts(options, scenario, planned, one, MeasuredSeries, console)
    versions = {name: number for name, number in installed_versions().items() if number is not None}
    response_map = make_response_map(robot, box, found, command, versions)
    show_response_map(response_map, console)
    write_response_map(response_map, options.out)


def _name(cell: Cell) -> str:
    return f"{cell.face} face, w {cell.curve[0]!r}, {cell.depth_m!r} m, seed {cell.seed}"
