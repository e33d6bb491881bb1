"""The charts in the picture of a mission: tilt of the trunk, margins, torques, and error of the box."""

from itertools import groupby
from math import degrees
from typing import Final

import numpy as np

from agent_proc.figures import Axes, MaxNLocator
from agent_proc.reporting.mission_picture.parts import MAX_POINTS
from agent_proc.reporting.mission_record import MissionRecord
from agent_proc.reporting.style import BLUE, BOX, GOAL, RAW
from legpush.arrays import Floats, Indices
from legpush.messages.stepping import Motion, Push, Walk
from legpush.scene.conventions import CONTROL_PERIOD_S, JOINTS

PHASES: Final[dict[type[Motion], tuple[str, str]]] = {Walk: ("walk", "#f3f5f8"), Push: ("push", "#f6efe6")}
COM, ZMP, CAPTURE = "#009e73", "#cc79a7", "#e69f00"
LEAST_NAMED: Final = 0.08
"""Share of the mission's time below which a phase has no room for its name."""
ENVELOPE_POINTS: Final = 160
"""Points of a line that shows the least or largest value of its surroundings: one for a gait cycle or so."""
ERROR_TICKS: Final = (0, 1, 3, 10, 30, 100, 300, 1000)


def draw_tilt(axes: Axes, record: MissionRecord) -> None:
    """Pitch and roll of the trunk over time."""
    ticks = record.ticks()
    _shade_phases(axes, record)
    roll, pitch = np.degrees(ticks.roll_pitch_rad).T
    _draw_series(axes, ticks.time_s, pitch, RAW, "pitch")
    _draw_series(axes, ticks.time_s, roll, BLUE, "roll")
    axes.set(ylabel="angle [°]")
    axes.set_title("Trunk pitch and roll")
    _legend_above(axes)


def draw_margins(axes: Axes, record: MissionRecord) -> None:
    """Least margins of the CoM, the zero-moment point and the capture point over time."""
    ticks = record.ticks()
    _shade_phases(axes, record)
    for values, color, label in (
        (ticks.zmp_margin_m, ZMP, "ZMP"),
        (ticks.support_margin_m, COM, "CoM"),
        (ticks.capture_margin_m, CAPTURE, "capture point"),
    ):
        starts = _starts(len(values), ENVELOPE_POINTS)
        if np.isfinite(values).any():
            axes.plot(ticks.time_s[starts], 100.0 * np.fmin.reduceat(values, starts), color=color, lw=1.0, label=label)
    axes.axhline(0.0, color=RAW, lw=0.8)
    axes.set(ylabel="margin [cm]")
    axes.set_title("Least support margin")
    _legend_above(axes)


def draw_torques(axes: Axes, record: MissionRecord) -> None:
    """Largest torque of each kind of joint over time."""
    ticks = record.ticks()
    _shade_phases(axes, record)
    starts = _starts(len(ticks.time_s), ENVELOPE_POINTS)
    for values, color, label in zip(ticks.torques_n_m.T, (GOAL, BLUE, BOX), JOINTS, strict=True):
        if np.isfinite(values).any():
            largest = np.fmax.reduceat(values, starts)
            axes.plot(ticks.time_s[starts], largest, color=color, lw=1.0, label=label.replace("_", "-"))
    axes.set(xlabel="simulated time [s]", ylabel="torque [N m]", ylim=(0.0, None))
    axes.set_title("Largest torque of any leg")
    _legend_above(axes)


def draw_box_error(axes: Axes, record: MissionRecord) -> None:
    """Errors of the box over the push cycles in tolerances, so that one line means success."""
    goal = record.scenario.goal
    errors = [record.box_error(step) for step in record.push_cycles()]
    cycles = range(len(errors))
    position = [error.position_m / goal.position_tolerance_m for error in errors]
    angle = [degrees(error.angle_rad) / goal.angle_tolerance_deg for error in errors]
    axes.axhspan(0.0, 1.0, color=GOAL, alpha=0.1, lw=0)
    for values, color, label in (
        (position, BOX, f"position (in {100 * goal.position_tolerance_m:g} cm)"),
        (angle, BLUE, f"angle (in {goal.angle_tolerance_deg:g}°)"),
    ):
        axes.plot(cycles, values, color=color, label=label, marker="o", ms=2.6, lw=1.0)
    axes.set_yscale("symlog", linthresh=1.0, linscale=0.6)
    top = 1.6 * max([2.0, *position, *angle])
    axes.set(xlabel="push cycle", ylabel="error / tolerance", ylim=(0.0, top))
    axes.set_yticks([tick for tick in ERROR_TICKS if tick < top], minor=False)
    axes.set_yticks([], minor=True)
    axes.yaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_title("Box error")
    _legend_above(axes)


def _legend_above(axes: Axes) -> None:
    """Place the legend, if there is anything in it, on the line of the title, at the right."""
    if not axes.get_legend_handles_labels()[1]:
        return
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.1, handlelength=1.4)


def _draw_series(axes: Axes, time_s: Floats, values: Floats, color: str, label: str) -> None:
    """Draw a line over time as the band between the extremes of its chunks, so that thinning loses no extreme."""
    starts = _starts(len(values), MAX_POINTS // 4)
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    axes.fill_between(time_s[starts], low, high, color=color, lw=0.6, alpha=0.85, label=label)


def _starts(n: int, n_most: int) -> Indices:
    """Where the chunks of a long line begin, each of which is drawn by its extremes."""
    return np.linspace(0, n, min(n, n_most), endpoint=False).astype(np.intp)


def _shade_phases(axes: Axes, record: MissionRecord) -> None:
    """Shade the background by walking and pushing, and name each phase that is wide enough."""
    end_s = max(record.steps[-1].world.tick * CONTROL_PERIOD_S, 1.0)
    moving = [step for step in record.steps if isinstance(step.motion, Walk | Push) and len(step.ticks.time_s)]
    for kind, run in groupby(moving, key=lambda step: type(step.motion)):
        steps = list(run)
        name, color = PHASES[kind]
        begin, end = steps[0].ticks.time_s[0], steps[-1].ticks.time_s[-1]
        axes.axvspan(begin, end, color=color, lw=0, zorder=0)
        if end - begin >= LEAST_NAMED * end_s:
            where = axes.get_xaxis_transform()
            axes.text(begin, 0.96, f" {name}", transform=where, va="top", fontsize=7.5, color="#6b717b")
    axes.margins(y=0.25)
    axes.set_xlim(0.0, end_s)
