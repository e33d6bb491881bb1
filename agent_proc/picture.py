"""`mission.png`: the whole mission in one figure, from what its journal recorded."""

from itertools import groupby
from math import ceil, degrees
from pathlib import Path
from textwrap import shorten
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

from agent_proc.mission import MissionResult
from agent_proc.poses import distance_m, planar_pose
from agent_proc.record import Floats, MissionRecord, Step
from legpush.geometry import Pose2
from legpush.messages import BoxPathQuery, Follow, Motion, Plan, Push, TrunkPathQuery, Walk
from legpush.robot import CONTROL_PERIOD_S, FOOT_RECTANGLE_LENGTH_M, FOOT_RECTANGLE_WIDTH_M, LEGS
from legpush.room_shapes import Footprint, box_footprint, obstacle_footprint

STYLE: Final[dict[Any, Any]] = {
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.linewidth": 0.7,
    "axes.edgecolor": "#8a8f98",
    "axes.labelcolor": "#333840",
    "xtick.color": "#555b65",
    "ytick.color": "#555b65",
    "legend.frameon": False,
    "legend.fontsize": 8.5,
}
WALL, FLOOR, INK, GRID = "#3b3f46", "#ffffff", "#1b2a41", "#e6e8eb"
TREE, RAW, SMOOTH, TRUNK = "#9dbbdc", "#c8553d", "#4a9b6e", "#1b2a41"
FEET: Final = {"FL": "#e29b3e", "FR": "#c86b9b", "RL": "#6f63b5", "RR": "#3d9fb0"}
BOX, GOAL, BLUE = "#8d6748", "#2b8a4b", "#3a6ea5"
PHASES: Final[dict[type[Motion], tuple[str, str]]] = {Walk: ("walk", "#f3f5f8"), Push: ("push", "#f6efe6")}
LEAST_NAMED: Final = 0.08
"""Share of the mission's time below which a phase has no room for its name."""
DPI: Final = 160
HEADLINE_LENGTH: Final = 140
MAX_POINTS: Final = 4000
"""Longer lines are thinned: more cannot be seen."""
WORLD: Final = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
ZOOM_ASPECT: Final = 2.45
PLAN_ASPECT: Final = 1.15
AROUND_M: Final = 2.0
BEHIND_M: Final = np.array([0.6, 0.2])
BESIDE_M: Final = np.array([0.1, 0.2])
ERROR_TICKS: Final = (0, 1, 3, 10, 30, 100, 300, 1000)
N_GHOSTS: Final = 8
"""Outlines of the box on its way."""


def save_picture(record: MissionRecord, result: MissionResult, path: Path) -> None:
    """Draw the mission and write it as PNG."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(13.6, 7.8), layout=ConstrainedLayoutEngine(w_pad=0.1, h_pad=0.06))
        FigureCanvasAgg(figure)
        grid = figure.add_gridspec(4, 2, width_ratios=[1.42, 1.0], height_ratios=[2.5, 1.0, 1.0, 1.15])
        plan = figure.add_subplot(grid[:, 0])
        _draw_plan(plan, record, result)
        _draw_zoom(figure.add_subplot(grid[0, 1]), record)
        tilt = figure.add_subplot(grid[1, 1])
        _draw_tilt(tilt, record)
        _draw_margin(figure.add_subplot(grid[2, 1], sharex=tilt), record)
        _draw_box_error(figure.add_subplot(grid[3, 1]), record)
        handles, labels = plan.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=ceil(len(labels) / 2))
        figure.suptitle(_headline(record, result), x=0.012, ha="left", fontsize=11.5, fontweight="bold", color=INK)
        figure.savefig(path, dpi=DPI)


def _headline(record: MissionRecord, result: MissionResult) -> str:
    outcome = "success" if result.success else result.reason.replace("_", " ")
    return shorten(f"{record.scenario.name}, seed {record.seed}: {outcome} · {result.detail}", HEADLINE_LENGTH)


def _draw_plan(axes: Axes, record: MissionRecord, result: MissionResult) -> None:
    """The room with everything that happened in it."""
    _draw_room(axes, record)
    _draw_trunk_plans(axes, [each.plan for each in record.plans if isinstance(each.query, TrunkPathQuery)])
    if record.scenario.reference is not None:
        axes.plot(*record.steps[0].box_path_m.T, color=GOAL, lw=1.6, ls=(0, (4, 1)), label="reference", zorder=6)
    _draw_box_plans(axes, [each.plan for each in record.plans if isinstance(each.query, BoxPathQuery)])
    follows = [step for step in record.steps if isinstance(step.motion, Follow)]
    for index, step in enumerate(follows):
        label = "smoothed path" if index == 0 else None
        axes.plot(*step.path_m.T, color=SMOOTH, lw=3.2, alpha=0.45, label=label, zorder=3, solid_capstyle="round")
    _draw_feet(axes, record, WORLD, 0.55)
    axes.plot(*_thin(record.ticks().trunk_m).T, color=TRUNK, lw=1.1, label="trunk", zorder=5)
    _draw_robot(axes, planar_pose(record.steps[0].world.trunk), label="robot at start and end")
    _draw_robot(axes, planar_pose(record.steps[-1].world.trunk))
    if result.handover_distance_m is not None and len(follows) > 1:
        here = planar_pose(min(follows, key=lambda step: _off_handover_m(step, result)).world.trunk)
        label = f"hand-over, {result.handover_distance_m:.2f} m from the box"
        axes.plot(here.x_m, here.y_m, "o", ms=5.5, mfc="white", mec=INK, mew=1.2, ls="", label=label, zorder=7)
    _draw_box(axes, record)
    low, high = _extent(record)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.set_anchor("N")


def _draw_trunk_plans(axes: Axes, plans: list[Plan]) -> None:
    for index, plan in enumerate(plans):
        if plan.tree is not None and plan.tree.points_m:
            points = np.array(plan.tree.points_m)
            edges = np.stack([points, points[list(plan.tree.parents)]], axis=1)
            label = "search tree" if index == 0 else None
            axes.add_collection(LineCollection(list(edges), colors=TREE, linewidths=0.5, label=label, zorder=2))
        raw = np.array(plan.raw_path_m).reshape(-1, 2)
        axes.plot(*raw.T, color=RAW, lw=0.9, ls=(0, (4, 2)), label="raw path" if index == 0 else None, zorder=3)


def _draw_box_plans(axes: Axes, plans: list[Plan]) -> None:
    """The first path of the box, and more lightly those that were planned on the way."""
    for index, plan in enumerate(plans):
        path = np.array([[pose.x_m, pose.y_m] for pose in plan.waypoints]).reshape(-1, 2)
        label = "planned path of the box" if index == 0 else None
        alpha = 1.0 if index == 0 else 0.4
        axes.plot(*path.T, color=GOAL, lw=1.6, ls=(0, (1, 1)), alpha=alpha, label=label, zorder=6)


def _off_handover_m(step: Step, result: MissionResult) -> float:
    apart_m = distance_m(planar_pose(step.world.trunk), planar_pose(step.world.box))
    return abs(apart_m - (result.handover_distance_m or 0.0))


def _draw_zoom(axes: Axes, record: MissionRecord) -> None:
    """The neighbourhood of the box, turned so that the goal's heading is to the right."""
    scenario = record.scenario
    seen = scenario.goal.pose.pose().inverse()
    _draw_room(axes, record, seen)
    _draw_feet(axes, record, seen, 0.7)
    axes.plot(*seen.apply(_thin(record.ticks().trunk_m)).T, color=TRUNK, lw=0.7, alpha=0.8, zorder=5)
    _draw_robot(axes, planar_pose(record.steps[-1].world.trunk), seen)
    _draw_box(axes, record, seen)
    outlines = [_box_at(record, step).corners() for step in (record.steps[0], record.steps[-1])]
    corners = seen.apply(np.concatenate([*outlines, box_footprint(scenario.box, scenario.goal.pose.pose()).corners()]))
    low, high = _widen(corners.min(axis=0) - BEHIND_M, corners.max(axis=0) + BESIDE_M, ZOOM_ASPECT)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.set(xlabel="along the goal's heading, from the goal [m]", ylabel="across [m]")
    axes.set_title("Pushing")


def _draw_room(axes: Axes, record: MissionRecord, seen: Pose2 = WORLD) -> None:
    room = record.scenario.room
    axes.set_facecolor(FLOOR)
    axes.grid(color=GRID, lw=0.6, zorder=0)
    axes.set_axisbelow(True)
    for index, obstacle in enumerate(room.obstacles):
        corners = seen.apply(obstacle_footprint(obstacle).corners())
        axes.add_patch(Polygon(corners, color=WALL, lw=0, label="obstacle" if index == 0 else None, zorder=2.5))


def _draw_feet(axes: Axes, record: MissionRecord, seen: Pose2, width: float) -> None:
    tips = record.ticks().tips_m
    for index, leg in enumerate(LEGS):
        axes.plot(
            *seen.apply(_thin(tips[:, index, :2])).T,
            color=FEET[leg],
            lw=width,
            alpha=0.9,
            label=f"foot {leg}",
            zorder=4,
        )


def _draw_robot(axes: Axes, trunk: Pose2, seen: Pose2 = WORLD, label: str | None = None) -> None:
    """The foot rectangle and where its front is."""
    trunk = seen @ trunk
    outline = Footprint(pose=trunk, length_m=FOOT_RECTANGLE_LENGTH_M, width_m=FOOT_RECTANGLE_WIDTH_M).corners()
    axes.add_patch(Polygon(outline, fill=False, ec=INK, lw=1.1, label=label, zorder=6))
    nose = trunk.apply([[FOOT_RECTANGLE_LENGTH_M / 2, 0.0], [0.0, 0.0]])
    axes.plot(*nose.T, color=INK, lw=1.1, zorder=6)


def _draw_box(axes: Axes, record: MissionRecord, seen: Pose2 = WORLD) -> None:
    """Its start, its way, its end and its goal."""
    steps = record.pushing() or record.steps[-1:]
    ghosts = np.unique(np.linspace(0, len(steps) - 1, N_GHOSTS + 2, dtype=int))[1:-1]
    start, end = (seen.apply(_box_at(record, step).corners()) for step in (record.steps[0], record.steps[-1]))
    goal = seen.apply(box_footprint(record.scenario.box, record.scenario.goal.pose.pose()).corners())
    for index in ghosts:
        corners = seen.apply(_box_at(record, steps[index]).corners())
        axes.add_patch(Polygon(corners, fill=False, ec=BOX, lw=0.6, alpha=0.55, zorder=5))
    axes.add_patch(Polygon(start, fill=False, ec=BOX, lw=1.3, ls=(0, (3, 1.5)), label="box at start", zorder=5))
    axes.add_patch(Polygon(end, fc=BOX, ec=BOX, alpha=0.45, lw=1.3, label="box at end", zorder=5))
    track = seen.apply(_thin(record.ticks().box[:, :2]))
    axes.plot(*track.T, color=BOX, lw=1.3, label="box track", zorder=6)
    axes.add_patch(Polygon(goal, fill=False, ec=GOAL, lw=1.6, label="goal", zorder=6))


def _draw_tilt(axes: Axes, record: MissionRecord) -> None:
    ticks = record.ticks()
    _shade_phases(axes, record)
    roll, pitch = np.degrees(ticks.roll_pitch_rad).T
    _draw_series(axes, ticks.time_s, pitch, RAW, "pitch")
    _draw_series(axes, ticks.time_s, roll, BLUE, "roll")
    axes.set(ylabel="angle [°]")
    axes.set_title("Trunk pitch and roll")
    _legend_above(axes)


def _draw_margin(axes: Axes, record: MissionRecord) -> None:
    ticks = record.ticks()
    _shade_phases(axes, record)
    _draw_series(axes, ticks.time_s, 100.0 * ticks.support_margin_m, "#4a6b5d", "")
    axes.axhline(0.0, color=RAW, lw=0.8)
    axes.set(xlabel="simulated time [s]", ylabel="margin [cm]")
    axes.set_title("Support margin of the CoM")


def _draw_box_error(axes: Axes, record: MissionRecord) -> None:
    """In tolerances, so that one line means success."""
    goal = record.scenario.goal
    errors = [record.box_error(step) for step in record.pushing()]
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
    """On the line of the title, at the right."""
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1, handlelength=1.4)


def _draw_series(axes: Axes, time_s: Floats, values: Floats, color: str, label: str) -> None:
    """A line over time that keeps its extremes however long it is: the band between them, chunk by chunk."""
    starts = np.linspace(0, len(values), min(len(values), MAX_POINTS // 4), endpoint=False).astype(int)
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    axes.fill_between(time_s[starts], low, high, color=color, lw=0.6, alpha=0.85, label=label)


def _shade_phases(axes: Axes, record: MissionRecord) -> None:
    """Walking and pushing, told apart by the background, with a name where there is room."""
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


def _box_at(record: MissionRecord, step: Step) -> Footprint:
    return box_footprint(record.scenario.box, planar_pose(step.world.box))


def _extent(record: MissionRecord) -> tuple[Floats, Floats]:
    """Lower left and upper right corner of the part of the room where something happened, with some space around."""
    scenario = record.scenario
    start, goal = _box_at(record, record.steps[0]), box_footprint(scenario.box, scenario.goal.pose.pose())
    planned = [np.array(each.plan.raw_path_m).reshape(-1, 2) for each in record.plans]
    trunks = np.array([planar_pose(step.world.trunk).xy() for step in record.steps])
    paths = [step.path_m for step in record.steps]
    points = np.concatenate([start.corners(), goal.corners(), *planned, trunks, *paths])
    low, high = _widen(points.min(axis=0) - AROUND_M, points.max(axis=0) + AROUND_M, PLAN_ASPECT)
    return np.maximum(low, 0.0), np.minimum(high, scenario.room.size_m)


def _widen(low: Floats, high: Floats, width_by_height: float) -> tuple[Floats, Floats]:
    """The smallest rectangle of that shape around the same centre that holds both corners."""
    centre, half = (low + high) / 2, (high - low) / 2
    height = max(half[1], half[0] / width_by_height)
    half = np.array([height * width_by_height, height])
    return centre - half, centre + half


def _thin(points: Floats) -> Floats:
    """Every n-th row, so that few enough are left, and the last one."""
    every = max(1, ceil(len(points) / MAX_POINTS))
    return np.concatenate([points[::every], points[-1:]])
