"""Draws `mission.png`, the whole mission in one figure, from its journal alone."""

from math import ceil
from pathlib import Path
from textwrap import shorten
from typing import Final

import numpy as np

from agent_proc.endings import MissionResult
from agent_proc.figures import Axes, ConstrainedLayoutEngine, Figure, LineCollection, Polygon, own_style, save_png
from agent_proc.reporting.charts import draw_box_error, draw_margins, draw_tilt, draw_torques
from agent_proc.reporting.mission_record import MissionRecord
from agent_proc.reporting.picture_parts import appeared, box_at, extent, followed, handover_place, thin, widen
from agent_proc.reporting.style import BOX, FLOOR, GOAL, GRID, INK, RAW, STYLE, WALL
from legpush.geometry import ORIGIN, Pose2
from legpush.messages.planning import BoxPathQuery, Plan, TrunkPathQuery
from legpush.messages.poses import planar_pose
from legpush.scene.conventions import CONTROL_PERIOD_S, LEGS
from legpush.scene.footprints import box_footprint, foot_rectangle, obstacle_footprint
from legpush.scene.occupancy import room_by_now
from legpush.scene.robot import RobotSpec

TREE, SMOOTH, TRUNK = "#9dbbdc", "#4a9b6e", "#1b2a41"
FEET: Final = {"FL": "#e29b3e", "FR": "#c86b9b", "RL": "#6f63b5", "RR": "#3d9fb0"}
APPEARED, GIVEN_UP = "#b8651b", "#77706a"
DPI: Final = 160
HEADLINE_LENGTH: Final = 140
ZOOM_ASPECT: Final = 2.45
BEHIND_M: Final = np.array([0.6, 0.2])
BESIDE_M: Final = np.array([0.1, 0.2])
N_GHOSTS: Final = 8
"""Number of outlines of the box on its way."""


def save_picture(record: MissionRecord, result: MissionResult, path: Path) -> None:
    """Draw the mission and write it as PNG."""
    with own_style(STYLE):
        figure = Figure(figsize=(13.6, 8.6), layout=ConstrainedLayoutEngine(w_pad=0.1, h_pad=0.06))
        grid = figure.add_gridspec(5, 2, width_ratios=[1.42, 1.0], height_ratios=[2.4, 1.0, 1.1, 1.0, 1.15])
        plan = figure.add_subplot(grid[:, 0])
        _draw_plan(plan, record, result)
        _draw_zoom(figure.add_subplot(grid[0, 1]), record)
        tilt = figure.add_subplot(grid[1, 1])
        draw_tilt(tilt, record)
        margins = figure.add_subplot(grid[2, 1], sharex=tilt)
        draw_margins(margins, record)
        for above in (tilt, margins):
            above.tick_params(labelbottom=False)
        draw_torques(figure.add_subplot(grid[3, 1], sharex=tilt), record)
        draw_box_error(figure.add_subplot(grid[4, 1]), record)
        handles, labels = plan.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=ceil(len(labels) / 2))
        figure.suptitle(_headline(record, result), x=0.012, ha="left", fontsize=11.5, fontweight="bold", color=INK)
        save_png(figure, path, dpi=DPI)


def _headline(record: MissionRecord, result: MissionResult) -> str:
    outcome = "success" if result.success else result.reason.replace("_", " ")
    return shorten(f"{record.scenario.name}, seed {record.seed}: {outcome} · {result.detail}", HEADLINE_LENGTH)


def _draw_plan(axes: Axes, record: MissionRecord, result: MissionResult) -> None:
    """Draw the room with the paths, feet, robot and box of the mission."""
    _draw_room(axes, record)
    _draw_trunk_plans(axes, [each.plan for each in record.plans if isinstance(each.query, TrunkPathQuery)])
    if record.scenario.reference is not None:
        axes.plot(*record.steps[0].box_path_m.T, color=GOAL, lw=1.6, ls=(0, (4, 1)), label="reference", zorder=6)
    _draw_box_plans(axes, [each.plan for each in record.plans if isinstance(each.query, BoxPathQuery)])
    follows = followed(record)
    labels = {False: "smoothed path", True: "path given up"}
    for step, given_up in follows:
        color, dashes = (GIVEN_UP, (0, (2, 1))) if given_up else (SMOOTH, "-")
        label = labels.pop(given_up, None)
        axes.plot(
            *step.path_m.T, color=color, lw=3.2, ls=dashes, alpha=0.45, label=label, zorder=3, solid_capstyle="round"
        )
    _draw_feet(axes, record, ORIGIN, 0.55)
    axes.plot(*thin(record.ticks().trunk_m).T, color=TRUNK, lw=1.1, label="trunk", zorder=5)
    _draw_robot(axes, record.scenario.robot, planar_pose(record.steps[0].world.trunk), label="robot at start and end")
    _draw_robot(axes, record.scenario.robot, planar_pose(record.steps[-1].world.trunk))
    if result.handover_distance_m is not None and len(follows) > 1:
        here = handover_place(record, result.handover_distance_m)
        label = f"hand-over, {result.handover_distance_m:.2f} m from the box"
        axes.plot(here.x_m, here.y_m, "o", ms=5.5, mfc="white", mec=INK, mew=1.2, ls="", label=label, zorder=7)
    _draw_box(axes, record)
    low, high = extent(record)
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
    """Draw the first path of the box, and paler the paths planned on the way."""
    for index, plan in enumerate(plans):
        path = np.array([[pose.x_m, pose.y_m] for pose in plan.waypoints]).reshape(-1, 2)
        label = "planned path of the box" if index == 0 else None
        alpha = 1.0 if index == 0 else 0.4
        axes.plot(*path.T, color=GOAL, lw=1.6, ls=(0, (1, 1)), alpha=alpha, label=label, zorder=6)


def _draw_zoom(axes: Axes, record: MissionRecord) -> None:
    """Draw the surroundings of the box, turned so that the goal's heading points to the right."""
    scenario = record.scenario
    seen = scenario.goal.pose.pose().inverse()
    _draw_room(axes, record, seen)
    _draw_feet(axes, record, seen, 0.7)
    axes.plot(*seen.apply(thin(record.ticks().trunk_m)).T, color=TRUNK, lw=0.7, alpha=0.8, zorder=5)
    _draw_robot(axes, record.scenario.robot, planar_pose(record.steps[-1].world.trunk), seen)
    _draw_box(axes, record, seen)
    outlines = [box_at(record, step).corners() for step in (record.steps[0], record.steps[-1])]
    corners = seen.apply(np.concatenate([*outlines, box_footprint(scenario.box, scenario.goal.pose.pose()).corners()]))
    low, high = widen(corners.min(axis=0) - BEHIND_M, corners.max(axis=0) + BESIDE_M, ZOOM_ASPECT)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.set(xlabel="along the goal's heading, from the goal [m]", ylabel="across [m]")
    axes.set_title("Pushing")


def _draw_room(axes: Axes, record: MissionRecord, seen: Pose2 = ORIGIN) -> None:
    room = record.scenario.room
    axes.set_facecolor(FLOOR)
    axes.grid(color=GRID, lw=0.6, zorder=0)
    axes.set_axisbelow(True)
    label: str | None = "obstacle"
    for obstacle in room_by_now(room, ()).obstacles:
        corners = seen.apply(obstacle_footprint(obstacle).corners())
        axes.add_patch(Polygon(corners, color=WALL, lw=0, label=label, zorder=2.5))
        label = None
    _draw_appeared(axes, record, seen)


def _draw_appeared(axes: Axes, record: MissionRecord, seen: Pose2) -> None:
    """Draw the obstacles that appeared, hatched, each with its time."""
    label: str | None = "appeared later"
    for each in appeared(record):
        place = obstacle_footprint(record.scenario.room.obstacles[each.obstacle])
        axes.add_patch(
            Polygon(seen.apply(place.corners()), fc=FLOOR, ec=APPEARED, hatch="/////", lw=1.0, label=label, zorder=2.5)
        )
        label = None
        x_m, y_m = seen.apply(place.pose.xy()[None])[0]
        axes.annotate(
            f"{each.tick * CONTROL_PERIOD_S:.0f} s",
            (x_m, y_m),
            xytext=(6, 0),
            textcoords="offset points",
            va="center",
            color=APPEARED,
            fontsize=8.0,
            fontweight="bold",
            clip_on=True,
            bbox={"fc": FLOOR, "ec": "none", "alpha": 0.8, "pad": 0.8},
            zorder=7,
        )


def _draw_feet(axes: Axes, record: MissionRecord, seen: Pose2, width: float) -> None:
    tips = record.ticks().tips_m
    for index, leg in enumerate(LEGS):
        axes.plot(
            *seen.apply(thin(tips[:, index, :2])).T,
            color=FEET[leg],
            lw=width,
            alpha=0.9,
            label=f"foot {leg}",
            zorder=4,
        )


def _draw_robot(axes: Axes, robot: RobotSpec, trunk: Pose2, seen: Pose2 = ORIGIN, label: str | None = None) -> None:
    """Draw the foot rectangle of the robot and a line to its front."""
    trunk = seen @ trunk
    feet = foot_rectangle(robot, trunk)
    axes.add_patch(Polygon(feet.corners(), fill=False, ec=INK, lw=1.1, label=label, zorder=6))
    nose = trunk.apply([[feet.length_m / 2, 0.0], [0.0, 0.0]])
    axes.plot(*nose.T, color=INK, lw=1.1, zorder=6)


def _draw_box(axes: Axes, record: MissionRecord, seen: Pose2 = ORIGIN) -> None:
    """Draw the box at start and end, its track, and its goal."""
    steps = record.pushing() or record.steps[-1:]
    ghosts = np.unique(np.linspace(0, len(steps) - 1, N_GHOSTS + 2, dtype=int))[1:-1]
    start, end = (seen.apply(box_at(record, step).corners()) for step in (record.steps[0], record.steps[-1]))
    goal = seen.apply(box_footprint(record.scenario.box, record.scenario.goal.pose.pose()).corners())
    for index in ghosts:
        corners = seen.apply(box_at(record, steps[index]).corners())
        axes.add_patch(Polygon(corners, fill=False, ec=BOX, lw=0.6, alpha=0.55, zorder=5))
    axes.add_patch(Polygon(start, fill=False, ec=BOX, lw=1.3, ls=(0, (3, 1.5)), label="box at start", zorder=5))
    axes.add_patch(Polygon(end, fc=BOX, ec=BOX, alpha=0.45, lw=1.3, label="box at end", zorder=5))
    track = seen.apply(thin(record.ticks().box[:, :2]))
    axes.plot(*track.T, color=BOX, lw=1.3, label="box track", zorder=6)
    axes.add_patch(Polygon(goal, fill=False, ec=GOAL, lw=1.6, label="goal", zorder=6))
