"""Rooms that nobody has seen before: obstacles, start, box and goal drawn from a seed, and always solvable.

First a push is drawn, over one to three faces of the box; then obstacles, which leave box and robot the space for it
and for the robot's walks from face to face; then a start from which the robot can come to the box. Besides, a disc as
wide as the corridor can move from the start to the box and on to its goal without touching anything.
"""

from itertools import pairwise
from math import degrees, hypot, pi
from typing import Final

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from legpush.errors import ConfigError, ScenarioError
from legpush.geometry import Pose2, wrap_angle
from legpush.random_push import DrawnPush, Stage, draw_push
from legpush.random_room import RandomRoom
from legpush.room import clearance_m
from legpush.room_shapes import Footprint, box_footprint, distance_m, distance_to_border_m, obstacle_footprint
from legpush.scenario import Box, Goal, Mission, Planning, PoseDeg, Randomization, Rectangle, Room, Scenario
from legpush.scenario_file_checks import check_scenario

Floats = NDArray[np.float64]

N_ROOMS: Final = 1000
"""Rooms that are tried."""
N_OBSTACLES: Final = 40
"""Places that are tried for each obstacle."""
N_STARTS: Final = 20
"""The same for the robot."""
CELL_M: Final = 0.1
"""Of the grid that discs move on."""
KEPT_M: Final = 0.15
"""What the drawn push keeps from obstacles and walls."""
WALK_RADIUS_M: Final = clearance_m(Planning()) + 0.1
"""Of the disc that can walk around the box, with space for the cells of the planner's map."""
STEPS_BACK_M: Final = (0.0, 0.2, 0.4)
"""From a stand-off: where the robot's way around the box may begin."""
MAX_PUSH_CYCLES: Final = 600
"""Enough for a path of 20 m."""
LEAST_WALK_M: Final = 1.5
"""From the start to the box, at least."""


def random_scenario(options: RandomRoom, seed: int) -> Scenario:
    """Equal seeds give equal rooms; `ConfigError` where none was found."""
    random = np.random.default_rng(seed)
    box = Box(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0), mass_kg=options.mass_kg, friction=options.friction)
    for _ in range(N_ROOMS):
        push = draw_push(options.size_m, box, random)
        obstacles = _obstacles(options, push, random)
        if obstacles is None:
            continue
        room = Room(size_m=options.size_m, obstacles=obstacles)
        scenario = _scenario(options, seed, room, push, random)
        if scenario is not None:
            return scenario
    raise ConfigError(
        f"Found no room with {options.obstacles} obstacles and corridors of {options.corridor_m} m in "
        f"{options.size_m[0]} x {options.size_m[1]} m: take fewer or smaller obstacles, or narrower corridors"
    )


def _obstacles(options: RandomRoom, push: DrawnPush, random: np.random.Generator) -> tuple[Rectangle, ...] | None:
    """Away from the push; None where that fails, or leads out of the room or to a place that is too near."""
    begin, end = push.stages[0].poses[0], push.stages[-1].poses[-1]
    swept = list(push.footprints())
    corners = np.concatenate([footprint.corners() for footprint in swept])
    if hypot(end.x_m - begin.x_m, end.y_m - begin.y_m) < options.push_m:
        return None
    if distance_to_border_m(corners, Room(size_m=options.size_m)) < KEPT_M:
        return None
    found: list[Rectangle] = []
    for _ in range(options.obstacles):
        for _ in range(N_OBSTACLES):
            obstacle = _obstacle(options, random)
            if _is_clear(obstacle, swept):
                found.append(obstacle)
                break
        else:
            return None
    return tuple(found)


def _obstacle(options: RandomRoom, random: np.random.Generator) -> Rectangle:
    length_m, width_m = random.uniform(*options.obstacle_m, size=2).round(2).tolist()
    x_m, y_m = (float(random.uniform(0.0, side)) for side in options.size_m)
    return Rectangle(
        x_min_m=round(x_m - length_m / 2, 2),
        x_max_m=round(x_m - length_m / 2 + length_m, 2),
        y_min_m=round(y_m - width_m / 2, 2),
        y_max_m=round(y_m - width_m / 2 + width_m, 2),
    )


def _is_clear(obstacle: Rectangle, swept: list[Footprint]) -> bool:
    solid = obstacle_footprint(obstacle)
    reach_m = hypot(solid.length_m, solid.width_m) / 2 + KEPT_M
    for footprint in swept:
        apart_m = hypot(footprint.pose.x_m - solid.pose.x_m, footprint.pose.y_m - solid.pose.y_m)
        near = apart_m <= reach_m + hypot(footprint.length_m, footprint.width_m) / 2
        if near and distance_m(solid, footprint) < KEPT_M:
            return False
    return True


def _scenario(
    options: RandomRoom, seed: int, room: Room, push: DrawnPush, random: np.random.Generator
) -> Scenario | None:
    """With a start from which the robot can come; None where there is none, or no way between two faces."""
    begin, end = push.stages[0].poses[0], push.stages[-1].poses[-1]
    if not all(_can_walk_around(room, push, *change) for change in pairwise(push.stages)):
        return None
    start = _start(options, room, push, random)
    if start is None:
        return None
    scenario = Scenario(
        name=f"random-{seed}",
        description=f"A random room: seed {seed}, {options.obstacles} obstacles, {options.corridor_m} m wide corridors",
        room=room,
        start=_in_degrees(start),
        box=replace(push.box, pose=_in_degrees(begin)),
        goal=Goal(
            pose=_in_degrees(end),
            position_tolerance_m=options.position_tolerance_m,
            angle_tolerance_deg=options.angle_tolerance_deg,
        ),
        mission=Mission(max_push_cycles=MAX_PUSH_CYCLES),
        randomization=Randomization(box_xy_m=options.box_xy_m, box_yaw_deg=options.box_yaw_deg),
    )
    try:
        check_scenario(scenario)
    except ScenarioError:
        return None
    return scenario


def _can_walk_around(room: Room, push: DrawnPush, before: Stage, after: Stage) -> bool:
    """Whether the robot, perhaps after some steps back, can walk from one face to the next."""
    pose = after.poses[0]
    around = Regions(room, WALK_RADIUS_M, box_footprint(push.box, pose))
    behind = push.stand_off(before, pose)
    places = [behind @ Pose2(x_m=-step_m, y_m=0.0, yaw_rad=0.0) for step_m in STEPS_BACK_M]
    goal = around.label(push.stand_off(after, pose))
    return goal > 0 and goal in {around.label(place) for place in places}


def _start(options: RandomRoom, room: Room, push: DrawnPush, random: np.random.Generator) -> Pose2 | None:
    """From where the robot can walk to the box, along corridors that lead on to the goal; None where none was found."""
    first, begin, end = push.stages[0], push.stages[0].poses[0], push.stages[-1].poses[-1]
    walk = Regions(room, WALK_RADIUS_M, box_footprint(push.box, begin))
    corridor = Regions(room, options.corridor_m / 2)
    if not corridor.label(begin) or corridor.label(begin) != corridor.label(end):
        return None
    for _ in range(N_STARTS):
        x_m, y_m, yaw_rad = random.uniform([0.0, 0.0, -pi], [*room.size_m, pi]).tolist()
        start = Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)
        far = hypot(x_m - begin.x_m, y_m - begin.y_m) >= LEAST_WALK_M
        reaches = 0 < walk.label(start) == walk.label(push.stand_off(first, begin))
        if far and reaches and corridor.label(start) == corridor.label(begin):
            return start
    return None


def _in_degrees(pose: Pose2) -> PoseDeg:
    return PoseDeg(x_m=round(pose.x_m, 3), y_m=round(pose.y_m, 3), yaw_deg=round(degrees(wrap_angle(pose.yaw_rad)), 1))


class Regions:
    """Parts of a room between which a disc can move without touching anything."""

    def __init__(self, room: Room, radius_m: float, box: Footprint | None = None) -> None:
        """The disc's radius, and a box that stands in its way."""
        self._xs, self._ys = (np.arange(CELL_M / 2, side, CELL_M) for side in room.size_m)
        x, y = np.meshgrid(self._xs, self._ys)
        clear = np.minimum.reduce([x, y, room.size_m[0] - x, room.size_m[1] - y])
        solid = [*map(obstacle_footprint, room.obstacles), *([] if box is None else [box])]
        for footprint in solid:
            seen = np.abs(footprint.pose.inverse().apply(np.stack([x.ravel(), y.ravel()], axis=1)))
            beyond = np.maximum(seen - np.array([footprint.length_m, footprint.width_m]) / 2, 0.0)
            clear = np.minimum(clear, np.hypot(*beyond.T).reshape(x.shape))
        free = clear >= radius_m
        self._labels = np.zeros(free.shape, dtype=np.int64)
        label = 0
        while (left := free & (self._labels == 0)).any():
            label += 1
            self._labels[_connected(free, tuple(np.argwhere(left)[0]))] = label

    def label(self, pose: Pose2) -> int:
        """Of the part that a pose is in; 0 where the disc does not fit."""
        column, row = int(pose.x_m / CELL_M), int(pose.y_m / CELL_M)
        inside = pose.x_m >= 0.0 and pose.y_m >= 0.0 and row < len(self._ys) and column < len(self._xs)
        return int(self._labels[row, column]) if inside else 0


def _connected(free: NDArray[np.bool_], cell: tuple[int, ...]) -> NDArray[np.bool_]:
    """All free cells that can be reached from one."""
    region = np.zeros_like(free)
    region[cell] = True
    size = 0
    while (grown := int(region.sum())) > size:
        size = grown
        region[1:] |= region[:-1] & free[1:]
        region[:-1] |= region[1:] & free[:-1]
        region[:, 1:] |= region[:, :-1] & free[:, 1:]
        region[:, :-1] |= region[:, 1:] & free[:, :-1]
    return region
