"""Geometry for the picture of a mission, in metres: outlines, abandoned paths, and the frame of the picture."""

from collections import Counter
from itertools import pairwise
from math import ceil
from typing import Final

import numpy as np

from agent_proc.reporting.mission_record import MissionRecord, MissionStep
from agent_proc.walking.obstacles import is_in_walk
from legpush.arrays import Floats
from legpush.geometry import Pose2, distance_m
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Appearance, Follow, Push, WorldState
from legpush.scene.footprints import Footprint, box_footprint
from legpush.scene.names import Face

MAX_POINTS: Final = 4000
"""Number of points above which a line is thinned, since more cannot be seen."""
PLAN_ASPECT: Final = 1.15
AROUND_M: Final = 2.0


def appeared(record: MissionRecord) -> tuple[Appearance, ...]:
    """The obstacles that have appeared by the end."""
    return record.steps[-1].world.appeared


def followed(record: MissionRecord) -> list[tuple[MissionStep, bool]]:
    """The step at which each path of the robot begins, and whether an obstacle then appeared in its remaining part."""
    begins = [index for index, step in enumerate(record.steps) if isinstance(step.motion, Follow)]
    ends = [*begins, len(record.steps)][1:]
    return [
        (record.steps[begin], _was_given_up(record, record.steps[begin], record.steps[end - 1].world))
        for begin, end in zip(begins, ends, strict=True)
    ]


def _was_given_up(record: MissionRecord, follow: MissionStep, last: WorldState) -> bool:
    """Whether an obstacle appeared in the way; `last` is the world before the next path."""
    if not isinstance(follow.motion, Follow) or last.path is None or last.path.done:
        return False
    obstacles = record.scenario.room.obstacles
    return any(
        is_in_walk(obstacles[new.obstacle], record.scenario, follow.motion.waypoints, last.path.travelled_m)
        for new in last.appeared[len(follow.world.appeared) :]
    )


def box_paths(record: MissionRecord) -> list[tuple[Floats, Pose2]]:
    """The paths along which the box was pushed, (m, 2) each, and where the box was when each of them began.

    A path that was planned but not pushed along is none of them.
    """
    found: list[tuple[Floats, Pose2]] = []
    for before, step in pairwise(record.steps):
        if isinstance(step.motion, Push) and not (found and step.box_path_m is found[-1][0]) and len(step.box_path_m):
            found.append((step.box_path_m, planar_pose(before.world.box)))
    return found


def planned_again(record: MissionRecord) -> Floats:
    """Where the robot or the box was when another path replaced the one before, (n, 2)."""
    walks = followed(record)
    trunks = [planar_pose(after.world.trunk) for (_, given_up), (after, _) in pairwise(walks) if given_up]
    boxes = [] if record.scenario.reference is not None else [box for _, box in box_paths(record)[1:]]
    return np.array([pose.xy() for pose in (*trunks, *boxes)]).reshape(-1, 2)


def pushed_faces(record: MissionRecord) -> list[Face]:
    """The faces that were pushed, the one with the most pushes first."""
    faces = Counter(step.motion.face for step in record.steps if isinstance(step.motion, Push))
    return [face for face, _ in faces.most_common()]


def handover_place(record: MissionRecord, handover_distance_m: float) -> Pose2:
    """Where the path began that the robot took at that distance from the box."""

    def off_m(step: MissionStep) -> float:
        return abs(distance_m(planar_pose(step.world.trunk), planar_pose(step.world.box)) - handover_distance_m)

    return planar_pose(min((step for step, _ in followed(record)), key=off_m).world.trunk)


def box_at(record: MissionRecord, step: MissionStep) -> Footprint:
    """Footprint of the box at the end of a step."""
    return box_footprint(record.scenario.box, planar_pose(step.world.box))


def extent(record: MissionRecord) -> tuple[Floats, Floats]:
    """Lower left and upper right corner of the part of the room that the mission used, with a margin."""
    scenario = record.scenario
    start, goal = box_at(record, record.steps[0]), box_footprint(scenario.box, scenario.goal.pose.pose())
    planned = [np.array(each.plan.raw_path_m).reshape(-1, 2) for each in record.plans]
    trunks = np.array([planar_pose(step.world.trunk).xy() for step in record.steps])
    paths = [step.path_m for step in record.steps]
    points = np.concatenate([start.corners(), goal.corners(), *planned, trunks, *paths])
    low, high = widen(points.min(axis=0) - AROUND_M, points.max(axis=0) + AROUND_M, PLAN_ASPECT)
    return np.maximum(low, 0.0), np.minimum(high, scenario.room.size_m)


def widen(low: Floats, high: Floats, width_by_height: float) -> tuple[Floats, Floats]:
    """The smallest rectangle with that ratio and the same centre that contains both corners."""
    centre, half = (low + high) / 2, (high - low) / 2
    height = max(half[1], half[0] / width_by_height)
    half = np.array([height * width_by_height, height])
    return centre - half, centre + half


def thin(points: Floats) -> Floats:
    """Every n-th row, so that at most `MAX_POINTS` are left, and the last row."""
    every = max(1, ceil(len(points) / MAX_POINTS))
    return np.concatenate([points[::every], points[-1:]])
