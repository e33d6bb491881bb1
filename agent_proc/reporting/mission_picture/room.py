"""Draws a room from above with what a mission did in it, in the frame of the world or in another one."""

from typing import Final

import numpy as np

from agent_proc.endings import MissionResult
from agent_proc.figures import Axes, LineCollection, Polygon
from agent_proc.reporting.mission_picture.parts import (
    appeared,
    box_at,
    box_paths,
    followed,
    handover_place,
    planned_again,
    thin,
)
from agent_proc.reporting.mission_record import MissionRecord
from agent_proc.reporting.style import APPEARED, BOX, FEET, FLOOR, GIVEN_UP, GOAL, GRID, INK, PATH, RAW, TREE, WALL
from legpush.geometry import ORIGIN, Pose2
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.messages.poses import planar_pose
from legpush.scene.conventions import CONTROL_PERIOD_S, LEGS
from legpush.scene.footprints import box_footprint, foot_rectangle, obstacle_footprint
from legpush.scene.occupancy import room_by_now
from legpush.scene.robot import RobotSpec

N_GHOSTS: Final = 8
"""Number of outlines of the box on its way."""
ROBOT: Final = "robot at start and end"


def draw_mission(axes: Axes, record: MissionRecord, result: MissionResult) -> None:
    """Draw the room with the paths, feet, robot and box of the mission."""
    draw_room(axes, record)
    _draw_searches(axes, [each.plan for each in record.plans if isinstance(each.query, TrunkPathQuery)])
    if record.scenario.reference is not None:
        axes.plot(*record.steps[0].box_path_m.T, color=GOAL, lw=1.6, ls=(0, (4, 1)), label="reference", zorder=6)
    follows = followed(record)
    labels = {False: "path that the robot followed", True: "path given up"}
    for step, given_up in follows:
        color, dashes = (GIVEN_UP, (0, (2, 1))) if given_up else (PATH, "-")
        label = labels.pop(given_up, None)
        axes.plot(*step.path_m.T, color=color, lw=3.2, ls=dashes, alpha=0.45, label=label, zorder=3)
    for index, (path_m, _) in enumerate(box_paths(record)):
        label = "path that the box followed" if index == 0 else None
        axes.plot(*path_m.T, color=GOAL, lw=1.6, ls=(0, (1, 1)), label=label, zorder=6)
    draw_feet(axes, record, ORIGIN, 0.55)
    if len(record.ticks().time_s):
        axes.plot(*thin(record.ticks().trunk_m).T, color=INK, lw=1.1, label="trunk", zorder=5)
    draw_robot(axes, record.scenario.robot, planar_pose(record.steps[0].world.trunk), label=ROBOT)
    draw_robot(axes, record.scenario.robot, planar_pose(record.steps[-1].world.trunk))
    if result.handover_distance_m is not None and len(follows) > 1:
        here = handover_place(record, result.handover_distance_m)
        label = f"hand-over, {result.handover_distance_m:.2f} m from the box"
        axes.plot(here.x_m, here.y_m, "o", ms=5.5, mfc="white", mec=INK, mew=1.2, ls="", label=label, zorder=7)
    draw_box(axes, record)
    if len(places := planned_again(record)):
        label = "another path from here"
        axes.plot(*places.T, "D", ms=5.5, mfc="white", mec=RAW, mew=1.3, ls="", label=label, zorder=8)
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")


def draw_room(axes: Axes, record: MissionRecord, seen: Pose2 = ORIGIN) -> None:
    """Draw the walls and blocks, and those that appeared later, in the frame `seen` of the world."""
    axes.set_facecolor(FLOOR)
    axes.grid(color=GRID, lw=0.6, zorder=0)
    axes.set_axisbelow(True)
    label: str | None = "obstacle"
    for obstacle in room_by_now(record.scenario.room, ()).obstacles:
        corners = seen.apply(obstacle_footprint(obstacle).corners())
        axes.add_patch(Polygon(corners, color=WALL, lw=0, label=label, zorder=2.5))
        label = None
    _draw_appeared(axes, record, seen)


def draw_feet(axes: Axes, record: MissionRecord, seen: Pose2, width: float) -> None:
    """Draw the way of each foot, if anything moved."""
    tips = record.ticks().tips_m
    if not len(tips):
        return
    for index, leg in enumerate(LEGS):
        xy = seen.apply(thin(tips[:, index, :2]))
        axes.plot(*xy.T, color=FEET[leg], lw=width, alpha=0.9, label=f"foot {leg}", zorder=4)


def draw_robot(axes: Axes, robot: RobotSpec, trunk: Pose2, seen: Pose2 = ORIGIN, label: str | None = None) -> None:
    """Draw the foot rectangle of the robot and a line to its front."""
    trunk = seen @ trunk
    feet = foot_rectangle(robot, trunk)
    axes.add_patch(Polygon(feet.corners(), fill=False, ec=INK, lw=1.1, label=label, zorder=6))
    nose = trunk.apply([[feet.length_m / 2, 0.0], [0.0, 0.0]])
    axes.plot(*nose.T, color=INK, lw=1.1, zorder=6)


def draw_box(axes: Axes, record: MissionRecord, seen: Pose2 = ORIGIN) -> None:
    """Draw the box where it started, its goal, and, if it was pushed, its track, some outlines, and where it ended."""
    start = seen.apply(box_at(record, record.steps[0]).corners())
    goal = seen.apply(box_footprint(record.scenario.box, record.scenario.goal.pose.pose()).corners())
    axes.add_patch(Polygon(start, fill=False, ec=BOX, lw=1.3, ls=(0, (3, 1.5)), label="box at start", zorder=5))
    axes.add_patch(Polygon(goal, fill=False, ec=GOAL, lw=1.6, label="goal", zorder=6))
    if not (steps := record.pushing()):
        return
    end = seen.apply(box_at(record, record.steps[-1]).corners())
    for index in np.unique(np.linspace(0, len(steps) - 1, N_GHOSTS + 2, dtype=int))[1:-1]:
        corners = seen.apply(box_at(record, steps[index]).corners())
        axes.add_patch(Polygon(corners, fill=False, ec=BOX, lw=0.6, alpha=0.55, zorder=5))
    axes.add_patch(Polygon(end, fc=BOX, ec=BOX, alpha=0.45, lw=1.3, label="box at end", zorder=5))
    axes.plot(*seen.apply(thin(record.ticks().box[:, :2])).T, color=BOX, lw=1.3, label="box track", zorder=6)


def _draw_searches(axes: Axes, plans: list[Plan]) -> None:
    """Draw the search trees, and the raw path that each of them found."""
    labels = ["search tree", "raw path"]
    for plan in plans:
        if plan.tree is not None and plan.tree.points_m:
            points = np.array(plan.tree.points_m)
            edges = np.stack([points, points[list(plan.tree.parents)]], axis=1)
            axes.add_collection(LineCollection(list(edges), colors=TREE, linewidths=0.5, label=labels[0], zorder=2))
            labels[0] = ""
        raw = np.array(plan.raw_path_m).reshape(-1, 2)
        if len(raw):
            axes.plot(*raw.T, color=RAW, lw=0.9, ls=(0, (4, 2)), label=labels[1], zorder=3)
            labels[1] = ""


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
