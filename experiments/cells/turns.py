"""The kind of cell that asks which way a box can be turned: the starts of a task, pushed with each leg and curve.

A box that turns the same way, whatever leg pushes it on whatever curve, cannot be steered from this face.
"""

from collections.abc import Collection, Mapping
from itertools import product
from math import degrees
from typing import Annotated, Any, Final

from msgspec import Meta, Struct

from agent_proc.studies.cell_parts import new_simulator
from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import scenario_of_start
from agent_proc.task.file import load_task
from legpush.errors import MotionError
from legpush.fields import Seed
from legpush.geometry import wrap_angle
from legpush.lockstep.simulator import Stepper
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column

CURVES: Final = ((0.5, 0.5), *product((0.0, 1.0), repeat=2))
"""w1 and w2: the usual curve, and those at the corners of their range."""
DEPTH_M: Final = 0.08
COLUMNS: Final = (
    Column(name="leg", unit="", about="by each series of pushes"),
    Column(name="w1", unit="", about="by each series"),
    Column(name="w2", unit="", about="by each series"),
    Column(name="turn_deg", unit="deg", about="by each series: how far its last push turned the box, to the left"),
)


class Turns(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A start as a study file sets it."""

    task: str
    seed: Seed = 0
    n_pushes: Annotated[int, Meta(ge=1, le=5)] = 2
    """Pushes of a series; one that is refused ends it."""


class ResolvedTurns(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A start that needs no other file."""

    task: TaskConfig
    seed: Seed
    n_pushes: int


def resolve(cell: Turns, _: Collection[str]) -> ResolvedTurns:
    """Load the task.

    Raises:
        ConfigError: There is no such task.
    """
    return ResolvedTurns(task=load_task(cell.task), seed=cell.seed, n_pushes=cell.n_pushes)


def run(cell: ResolvedTurns) -> Mapping[str, Any]:
    """Push the box of the start with each leg and curve, from the start every time."""
    scenario, simulator = scenario_of_start(cell.task, cell.seed), new_simulator()
    pushes = [Push(w1=w1, w2=w2, leg=leg, depth_m=DEPTH_M) for leg, (w1, w2) in product(FRONT_LEGS, CURVES)]
    return {
        "leg": [push.leg for push in pushes],
        "w1": [push.w1 for push in pushes],
        "w2": [push.w2 for push in pushes],
        "turn_deg": [round(_turn_deg(simulator, scenario, cell.seed, [push] * cell.n_pushes), 2) for push in pushes],
    }


def _turn_deg(simulator: Stepper, scenario: Scenario, seed: int, pushes: list[Push]) -> float:
    """How far the last of the pushes that are not refused turns the box."""
    outcome = simulator.perform(Reset(scenario=scenario, seed=seed), with_trace=False)
    turn_rad = 0.0
    for push in pushes:
        before_rad = planar_pose(outcome.world.box).yaw_rad
        try:
            outcome = simulator.perform(push, with_trace=False)
        except MotionError:
            break
        turn_rad = wrap_angle(planar_pose(outcome.world.box).yaw_rad - before_rad)
    return degrees(turn_rad)


TURNS: Final = CellKind(specification=Turns, run=run, resolved=ResolvedTurns, resolve=resolve, columns=COLUMNS)
"""The kind of cell."""
