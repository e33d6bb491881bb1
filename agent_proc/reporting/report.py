"""Computes `report.json`, the numbers of a mission, from its journal alone."""

from dataclasses import dataclass
from hashlib import sha256
from math import degrees, sqrt
from typing import Final

import numpy as np

from agent_proc.endings import MissionResult
from agent_proc.frames.poses import box_error
from agent_proc.reporting.mission_record import MissionRecord, MissionStep
from agent_proc.reporting.phases import phase_report, unexpected_notes
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import Push, Walk
from legpush.numerics.computed_with import computed_with
from legpush.runs.report import Appeared, Report
from legpush.scenarios.file import dump_scenario
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.paths import arc_lengths_m, distances_m

LOOK_AHEAD_M: Final = 0.5
"""Longest distance along its path that the box may advance in one push cycle."""


@dataclass(frozen=True, kw_only=True)
class Begun:
    """How a mission was begun."""

    policy: str
    planner: str | None = None
    """The command of another planner process; None for the planner of this package."""
    command: str = ""
    """The command of the mission; empty if a Python program began it."""


def make_report(
    record: MissionRecord, result: MissionResult, wall_time_s: float, versions: dict[str, str | None], begun: Begun
) -> Report:
    """Make the report on a mission."""
    last = record.steps[-1]
    error = record.box_error(last)
    seen = None if last.world.perceived is None else box_error(as_seen(last.world), record.scenario)
    ticks = record.ticks()
    tilt_deg = np.degrees(np.abs(ticks.roll_pitch_rad))
    sim_time_s = last.world.tick * CONTROL_PERIOD_S
    return Report(
        success=result.success,
        reason=result.reason,
        detail=result.detail,
        remedy=result.remedy,
        box_position_error_m=error.position_m,
        box_angle_error_deg=degrees(error.angle_rad),
        walk_tracking_rms_m=tracking_rms_m([step for step in record.steps if isinstance(step.motion, Walk)]),
        box_path_rms_m=box_path_rms_m(record.steps),
        handover_distance_m=result.handover_distance_m,
        trunk_max_abs_pitch_deg=float(tilt_deg[:, 1].max()) if len(tilt_deg) else None,
        trunk_max_abs_roll_deg=float(tilt_deg[:, 0].max()) if len(tilt_deg) else None,
        min_support_margin_m=float(ticks.support_margin_m.min()) if len(tilt_deg) else None,
        walking=phase_report([step for step in record.steps if isinstance(step.motion, Walk)], record.scenario.robot),
        pushing=phase_report([step for step in record.steps if isinstance(step.motion, Push)], record.scenario.robot),
        n_better_paths=result.n_better_paths,
        n_replans=result.n_replans,
        appeared=tuple(
            Appeared(obstacle=each.obstacle, time_s=each.tick * CONTROL_PERIOD_S) for each in last.world.appeared
        ),
        n_push_cycles=sum(isinstance(step.motion, Push) for step in record.steps),
        n_footsteps=last.world.n_footsteps,
        sim_time_s=sim_time_s,
        wall_time_s=wall_time_s,
        real_time_factor=sim_time_s / wall_time_s,
        state_crc=f"{last.state_crc:08x}",
        seed=record.seed,
        scenario=record.scenario.name,
        scenario_sha256=sha256(dump_scenario(record.scenario).encode()).hexdigest(),
        policy=begun.policy,
        planner=begun.planner or record.scenario.planning.planner,
        command=begun.command,
        numerics=computed_with(versions).numerics,
        versions=versions,
        notes=unexpected_notes(record.steps),
        perceived_box_position_error_m=None if seen is None else seen.position_m,
        perceived_box_angle_error_deg=None if seen is None else degrees(seen.angle_rad),
    )


def tracking_rms_m(walks: list[MissionStep]) -> float | None:
    """Root mean square distance of the trunk from its path, over all ticks; None if there are none."""
    squares = [distances_m(step.ticks.trunk_m, step.path_m) ** 2 for step in walks]
    n_ticks = sum(map(len, squares))
    return sqrt(sum(float(part.sum()) for part in squares) / n_ticks) if n_ticks else None


def box_path_rms_m(steps: list[MissionStep]) -> float | None:
    """Root mean square distance of the box's centre from its path, over all push cycles; None if there are none.

    The box advances along its path from beginning to end: where the path comes near itself, the part ahead counts.
    """
    squares: list[float] = []
    path_m, progress = np.empty((0, 2)), 0
    for step in steps:
        if not isinstance(step.motion, Push) or not len(step.box_path_m):
            continue
        if step.box_path_m is not path_m:
            path_m, progress = step.box_path_m, 0
            at_m = arc_lengths_m(path_m)
        end = int(np.searchsorted(at_m, at_m[progress] + LOOK_AHEAD_M, side="right"))
        point = planar_pose(step.world.box).xy()
        ahead = path_m[progress : max(end, progress + 2)]
        squares.append(float(distances_m(point[None], ahead)[0]) ** 2)
        progress += int(np.hypot(*(ahead - point).T).argmin())
    return sqrt(sum(squares) / len(squares)) if squares else None
