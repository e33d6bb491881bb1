"""Measures the parts of a calibration, and keeps the finished ones so that the same command goes on."""

import threading
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path

import msgspec
from rich.console import Console
from rich.text import Text

from agent_proc.push_model.calibration import Measured, Part, in_worlds
from agent_proc.simulators import simulators
from legpush.errors import StopRequestedError
from legpush.lockstep.world import SteppingWorld
from legpush.long_work.finished import open_finished
from legpush.long_work.progress import counted
from legpush.numerics.current import current
from legpush.options.learning import CalibrateOptions
from legpush.runs.temporary import temporary_folder
from legpush.scene.scenario import Scenario
from legpush.service import stop_on_signals

Measure = Callable[[SteppingWorld, Part, threading.Event], Measured]
"""Measures a part in a world, until the event is set."""


def measure_parts(
    options: CalibrateOptions,
    scenario: Scenario,
    planned: Mapping[str, Part],
    measure: Measure[Part, Measured],
    result: type[Measured],
    console: Console,
) -> list[Measured]:
    """Measure the parts that are not finished yet; returns the results of all, in their order.

    Args:
        options: Which simulators to use, and the file to be written.
        scenario: It has the robot and the box that are measured.
        planned: The parts by their names, which must say everything about them.
        measure: Measures one.
        result: The type of a result, made of plain data.
        console: Shows the progress.

    Raises:
        StopRequestedError: The user interrupted it; the finished parts are kept.
    """
    stop, links_stop = stop_on_signals(), threading.Event()
    work = {
        "robot": msgspec.to_builtins(scenario.robot),
        "box": msgspec.to_builtins(scenario.box),
        "world": options.world,
        "legpush": version("legpush"),
        "numerics": current().name,
    }
    names = {part: name for name, part in planned.items()}
    with open_finished(unfinished(options.out), work) as kept, temporary_folder("calibrate-") as logs:
        before = {
            planned[name]: msgspec.convert(plain, result) for name, plain in kept.parts.items() if name in planned
        }
        if before:
            console.print(Text(f"{len(before)} of {len(planned)} series are finished already"), soft_wrap=True)
        with (
            counted(console, "pushing", len(planned), "series", done=len(before)) as advance,
            simulators(options, logs, links_stop, kind="calibrate") as worlds,
        ):

            def on_part(part: Part, measured: Measured) -> None:
                kept.keep(names[part], msgspec.to_builtins(measured))
                advance()

            def one(world: SteppingWorld, part: Part) -> Measured:
                return measure(world, part, stop)

            try:
                return in_worlds(worlds, list(planned.values()), one, on_part, before)
            except StopRequestedError as error:
                if not kept.parts:
                    raise StopRequestedError("interrupted: no series was finished") from error
                raise StopRequestedError(
                    f"interrupted: {len(kept.parts)} of {len(planned)} series are kept in {kept.path}; the same "
                    "command goes on"
                ) from error
            finally:
                links_stop.set()


def unfinished(out: Path) -> Path:
    """The file of the finished series while the map is not finished."""
    return out.with_name(f"{out.name}.unfinished")
