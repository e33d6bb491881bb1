"""The kind of cell that pushes a box once along a curve of any degree and of either locus (Eqs. 14 and 15).

Lengths along and across the push are in the frame of the pushed face, and those of right pushes are mirrored, so that
both legs give the same numbers if they do the same.
"""

from collections.abc import Mapping
from math import atan2, degrees
from typing import Annotated, Any, Final

import numpy as np
from msgspec import Meta, Struct
from msgspec.structs import replace

from agent_proc.push_model.calibration import open_floor
from agent_proc.push_model.model import MIRROR
from legpush.arrays import Floats
from legpush.bounds import MAX_DEPTH_M, Unit
from legpush.errors import MotionError
from legpush.fields import Seed
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Outcome, Push, Reset, Trace
from legpush.scene.conventions import CONTROL_PERIOD_S, LEGS, FrontLeg
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, PoseDeg, Scenario
from legpush.study.cells import CellKind, Column, as_it_is
from sim_proc.control.push_cycle import contact_point
from sim_proc.control.swing import Locus, bezier, control_points
from sim_proc.simulator import SimulatedEpisode

BOX: Final = slice(19, 21)
"""Place of the box's centre in a row of `qpos`."""
MOVED_M: Final = 5e-4
"""A foot that is this far from where it stood has begun its curve."""
LOW_M: Final = 5e-3
"""A foot whose surface is less above the floor is low."""
PUSHED_M_S: Final = 0.01
"""Speed of a box that the foot has reached."""

ROUNDED_M: Final = 1e-3
"""A point that the clip raises by less is on the floor: a standing foot sinks in by less than that."""
N_POINTS: Final = 101
"""Points of a curve."""

COLUMNS: Final = (
    Column(name="degree", unit="", about="of the curve"),
    Column(name="refused", unit="", about="why the push was refused before anything moved; empty if it was not"),
    Column(name="fell", unit="", about="whether the robot fell"),
    Column(name="forward_m", unit="m", about="way of the box along the push"),
    Column(name="left_m", unit="m", about="way of the box to the left, mirrored for FR"),
    Column(name="turn_deg", unit="deg", about="turn of the box to the left, mirrored for FR"),
    Column(name="peak_force_n", unit="N", about="largest force of the box on the foot"),
    Column(name="max_box_speed_m_s", unit="m/s", about="largest speed of the box"),
    Column(name="lowest_asked_m", unit="m", about="least height of the foot's surface on the curve without its clip"),
    Column(name="n_raised", unit="", about="inner control points that the clip at the floor has raised"),
    Column(name="low_way_m", unit="m", about="way of the foot at less than 5 mm above the floor"),
    Column(name="highest_m", unit="m", about="largest height of the foot's centre"),
    Column(name="way_m", unit="m", about="length of the foot's way"),
    Column(name="contact_height_m", unit="m", about="height of the foot's centre at the first contact"),
    Column(name="contact_speed_m_s", unit="m/s", about="speed of the foot before the first contact"),
    Column(name="contact_rise_deg", unit="deg", about="direction of the foot before it, upward from the floor"),
    Column(name="max_push_moment_n_m", unit="N m", about="largest horizontal part of the sum of Eq. 9"),
    Column(name="foot_x_m", unit="m", about="way of the foot along the push, by tick of the curve"),
    Column(name="foot_z_m", unit="m", about="height of the foot's centre, by tick of the curve"),
    Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state"),
)


class PushCurve(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One push from the place where the robot stands ready for it."""

    weights: Annotated[tuple[Unit, ...], Meta(max_length=8)]
    """Places of the inner control points on their locus: as many as the degree less one."""
    locus: Locus
    leg: FrontLeg
    depth_m: Annotated[float, Meta(gt=0.0, le=MAX_DEPTH_M)]
    box_height_m: Annotated[float, Meta(gt=0.0)] = 0.4
    seed: Seed


def push_curve(cell: PushCurve) -> Mapping[str, Any]:
    """Push a box of the default length and width once; all measures are None if the push is refused."""
    usual = Box(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0))
    box = replace(usual, size_m=(*usual.size_m[:2], cell.box_height_m))
    scenario = open_floor(RobotSpec(), box, "rear")
    episode = SimulatedEpisode(Reset(scenario=scenario, seed=cell.seed))
    start = episode.outcome([], with_trace=False)
    push = Push(w1=0.5, w2=0.5, leg=cell.leg, depth_m=cell.depth_m, locus=cell.locus)
    head = {"degree": len(cell.weights) + 1}
    try:
        outcome = episode.push(push, cell.weights, with_trace=True)
    except MotionError as error:
        nothing = {column.name: None for column in COLUMNS}
        return {**nothing, **head, "refused": str(error), "fell": False, "state_crc": f"{start.state_crc:08x}"}
    return {**head, "refused": "", **_measured(cell, scenario, planar_pose(start.world.box), outcome)}


def _measured(cell: PushCurve, scenario: Scenario, before: Pose2, outcome: Outcome) -> dict[str, Any]:
    robot, box = scenario.robot, scenario.box
    trace, measures, report = outcome.trace, outcome.measures, outcome.world.push
    if trace is None or measures is None or report is None:
        raise RuntimeError("Expected trace, measures and report of a push, got none")
    moved = before.inverse() @ planar_pose(outcome.world.box)
    foot = foot_path(trace, LEGS.index(cell.leg), robot.pushing.push_ticks)
    along_m = before.inverse().apply(foot.tips_m[:, :2])[:, 0]
    steps_m, box_steps_m = np.diff(foot.tips_m, axis=0), np.diff(foot.qpos[:, BOX], axis=0)
    ways_m, speeds_m_s = np.linalg.norm(steps_m, axis=1), np.linalg.norm(box_steps_m, axis=1) / CONTROL_PERIOD_S
    bottom_m = foot.tips_m[1:, 2] - robot.legs.foot_radius_m
    pushed = np.flatnonzero(speeds_m_s > PUSHED_M_S)
    goal_m = contact_point(robot, box, before, "rear", cell.leg, cell.depth_m)
    asked_m, raised = asked_curve(cell, foot.tips_m[0], goal_m, robot.legs.foot_radius_m)
    found = {
        "fell": outcome.world.fallen,
        "forward_m": moved.x_m,
        "left_m": MIRROR[cell.leg] * moved.y_m,
        "turn_deg": MIRROR[cell.leg] * degrees(moved.yaw_rad),
        "peak_force_n": report.peak_force_n,
        "max_box_speed_m_s": float(speeds_m_s.max()),
        "lowest_asked_m": float(asked_m[:, 2].min()) - robot.legs.foot_radius_m,
        "n_raised": raised,
        "low_way_m": float(ways_m[bottom_m < LOW_M].sum()),
        "highest_m": float(foot.tips_m[:, 2].max()),
        "way_m": float(ways_m.sum()),
        "contact_height_m": None,
        "contact_speed_m_s": None,
        "contact_rise_deg": None,
        "max_push_moment_n_m": measures.max_push_moment_n_m,
        "foot_x_m": (along_m - along_m[0]).round(4),
        "foot_z_m": foot.tips_m[:, 2].round(4),
        "state_crc": f"{outcome.state_crc:08x}",
    }
    if len(pushed):
        step_m = steps_m[max(pushed[0] - 1, 0)]
        found["contact_height_m"] = float(foot.tips_m[pushed[0], 2])
        found["contact_speed_m_s"] = float(np.linalg.norm(step_m)) / CONTROL_PERIOD_S
        found["contact_rise_deg"] = degrees(atan2(step_m[2], float(np.hypot(step_m[0], step_m[1]))))
    return found


def asked_curve(cell: PushCurve, start_m: Floats, goal_m: Floats, floor_m: float) -> tuple[Floats, int]:
    """Return the curve as Eq. 15 asks for it, (n, 3), and how many of its inner control points are below the floor."""
    points = control_points(start_m, goal_m, cell.weights, cell.locus, -np.inf)
    return bezier(points, np.linspace(0.0, 1.0, N_POINTS)), int(np.sum(points[1:-1, 2] < floor_m - ROUNDED_M))


class FootPath(Struct, frozen=True, kw_only=True):
    """A foot along its curve, and robot and box, a row for each tick and one for where they stood."""

    first_row: int
    """Row of the trace that is the first one here."""
    tips_m: Floats
    """Centre of the foot, (n + 1, 3)."""
    forces_n: Floats
    """Force on it, from floor and box, (n + 1, 3)."""
    qpos: Floats
    """Generalized positions as in a trace, (n + 1, 26)."""


def foot_path(trace: Trace, leg: int, n_ticks: int) -> FootPath:
    """Return the part of a trace in which a foot moves along its curve of `n_ticks`."""
    tips_m = np.array(trace.tips_m)[:, leg]
    away_m = np.linalg.norm(tips_m - tips_m[0], axis=1)
    begin = max(int(np.argmax(away_m > MOVED_M)) - 1, 0)
    rows = slice(begin, begin + n_ticks + 1)
    forces_n = np.array(trace.contact_forces_n)[rows, leg]
    return FootPath(first_row=begin, tips_m=tips_m[rows], forces_n=forces_n, qpos=np.array(trace.qpos)[rows])


PUSH_CURVE: Final = CellKind(
    specification=PushCurve, run=push_curve, resolved=PushCurve, resolve=as_it_is, columns=COLUMNS
)
"""The kind of cell."""
