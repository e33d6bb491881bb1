"""The kind of cell `calibration`: a series of equal pushes at a box on an open floor, with both legs."""

from collections.abc import Collection, Mapping, Sequence
from math import degrees
from statistics import fmean
from typing import Annotated, Any, Final

from msgspec import Meta, Struct

from agent_proc.push_model.calibration import CalibrationError, Cell, open_floor, push_series
from agent_proc.studies.cell_parts import STATE_CRC, new_simulator, scenario_of
from legpush.bounds import MAX_DEPTH_M, Unit
from legpush.errors import ConfigError
from legpush.fields import Seed
from legpush.lockstep.local import LocalWorld
from legpush.messages.common import USUAL_DEPTH_M
from legpush.scene.conventions import CONTROL_PERIOD_S, FRONT_LEGS
from legpush.scene.faces import PUSHABLE
from legpush.scene.names import Face
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Scenario
from legpush.study.cells import CellKind, Column

_MEASURES: Final = (("forward_m", "m"), ("left_m", "m"), ("turn_deg", "deg"))
COLUMNS: Final = (
    *(
        Column(name=f"{leg.lower()}_{name}", unit=unit, about=f"mean of the pushes with {leg}, in the pushed frame")
        for leg in FRONT_LEGS
        for name, unit in _MEASURES
    ),
    Column(name="legs", unit="", about="leg of each push"),
    *(Column(name=f"each_{name}", unit=unit, about="by each push, in the pushed frame") for name, unit in _MEASURES),
    Column(name="max_abs_tilt_deg", unit="deg", about="largest roll or pitch of the trunk"),
    Column(name="min_support_margin_m", unit="m", about="least distance of the CoM from the border of its support"),
    Column(name="longest_push_s", unit="s", about="simulated time of the longest push"),
    STATE_CRC,
)


class CalibrationCell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A series as a study file sets it."""

    seed: Seed = 0
    """Seed of the place of the box."""
    scenario: str = "push"
    """The scenario with the box."""
    face: Face = "rear"
    """The face that is pushed."""
    w1: Unit = 0.5
    """Height of the first inner control point of the foot's curve."""
    w2: Unit = 0.5
    """Height of the second one."""
    depth_m: Annotated[float, Meta(gt=0.0, le=MAX_DEPTH_M)] = USUAL_DEPTH_M
    """How far the foot goes beyond the face."""
    changes: dict[str, Any] = {}
    """Fields of the scenario, by their path."""


class ResolvedCalibration(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A series that needs no other file."""

    seed: Seed
    robot: RobotSpec
    box: Box
    face: Face
    w1: float
    w2: float
    depth_m: float


def resolve(cell: CalibrationCell, _: Collection[str]) -> ResolvedCalibration:
    """Load the box.

    Raises:
        ScenarioError: The scenario or a change cannot be used.
        ConfigError: This face of the box cannot be pushed.
    """
    scenario = scenario_of(cell.scenario, cell.changes)
    box = scenario.box
    if cell.face not in PUSHABLE[box.shape]:
        raise ConfigError(f"Expected a face of a {box.shape} among {', '.join(PUSHABLE[box.shape])}, got {cell.face}")
    return ResolvedCalibration(
        seed=cell.seed,
        robot=scenario.robot,
        box=box,
        face=cell.face,
        w1=cell.w1,
        w2=cell.w2,
        depth_m=cell.depth_m,
    )


def run(cell: ResolvedCalibration) -> Mapping[str, Any]:
    """Push the box again and again."""
    series = Cell(face=cell.face, curve=(cell.w1, cell.w2), depth_m=cell.depth_m, seed=cell.seed)
    legs: list[str] = []
    each: dict[str, list[float]] = {name: [] for name, _ in _MEASURES}
    tilts_deg, margins_m, times_s = list[float](), list[float](), list[float]()
    scenario = open_floor(cell.robot, cell.box, cell.face)
    for push, moved, outcome in push_series(LocalWorld(new_simulator()), scenario, series):
        legs.append(push.leg)
        for name, value in zip(each, (moved.x_m, moved.y_m, degrees(moved.yaw_rad)), strict=True):
            each[name].append(value)
        if (trace := outcome.trace) is None:
            raise CalibrationError("Expected a trace of each push, got none")
        tilts_deg.append(degrees(max(abs(angle) for angles in trace.roll_pitch_rad for angle in angles)))
        margins_m.append(min(trace.support_margin_m))
        times_s.append(len(trace.tick) * CONTROL_PERIOD_S)
        crc = outcome.state_crc
    means = {
        f"{leg.lower()}_{name}": fmean(_of_leg(leg, legs, values))
        for leg in FRONT_LEGS
        for name, values in each.items()
    }
    lists = {f"each_{name}": values for name, values in each.items()}
    extremes = {
        "max_abs_tilt_deg": max(tilts_deg),
        "min_support_margin_m": min(margins_m),
        "longest_push_s": max(times_s),
    }
    return {**means, "legs": legs, **lists, **extremes, "state_crc": f"{crc:08x}"}


def _of_leg(leg: str, legs: Sequence[str], values: Sequence[float]) -> list[float]:
    return [value for one, value in zip(legs, values, strict=True) if one == leg]


CALIBRATION: Final = CellKind(
    specification=CalibrationCell,
    run=run,
    resolved=ResolvedCalibration,
    resolve=resolve,
    columns=COLUMNS,
    changes=Scenario,
)
"""The kind of cell."""
