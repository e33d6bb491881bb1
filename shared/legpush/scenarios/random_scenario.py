"""Draws rooms with obstacles, start, box and goal from a seed, until one is solvable.

A disc as wide as the corridor can move from the robot's start to the box and on to its goal without touching anything,
and robot and box have the space that every scenario must give them.
"""

from collections.abc import Callable
from math import hypot
from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats, Indices, Integers
from legpush.errors import ConfigError, ScenarioError
from legpush.geometry import Pose2
from legpush.realism.settings import Randomization
from legpush.scenarios.checks import check_scenario
from legpush.scenarios.random_room import RandomRoom
from legpush.scene.scenario import Box, Goal, PoseDeg, Rectangle, Room, Scenario

N_ROOMS: Final = 200
"""Most sets of obstacles to try."""
N_PLACES: Final = 100
"""Most places of start, box and goal to try for each set of obstacles."""
N_UNSOLVABLE: Final = 20
"""Give up after this many unsolvable rooms."""
CELL_M: Final = 0.1
"""Cell size of the grid that the disc moves on."""
LEAST_WALK_M: Final = 1.5
"""Least distance from the start to the box."""


def random_scenario(options: RandomRoom, seed: int, is_solvable: Callable[[Scenario], bool]) -> Scenario:
    """Return the first room of the seed that `is_solvable`; equal seeds give equal rooms.

    Raises:
        ConfigError: No solvable room was found.
    """
    random = np.random.default_rng(seed)
    n_asked = 0
    for _ in range(N_ROOMS):
        room = Room(size_m=options.size_m, obstacles=_obstacles(options, random))
        centres, labels = _passages(room, options.corridor_m)
        free = np.argwhere(labels > 0)
        for _ in range(N_PLACES if len(free) else 0):
            start, box, goal = (_pose(centres, free, labels, random) for _ in range(3))
            if len({label for _, label in (start, box, goal)}) > 1:
                continue
            scenario = _scenario(options, seed, room, start[0], box[0], goal[0])
            if not _is_worth_it(scenario, options):
                continue
            if is_solvable(scenario):
                return scenario
            n_asked += 1
            if n_asked == N_UNSOLVABLE:
                raise ConfigError(f"None of {n_asked} rooms was solvable: take fewer obstacles, or wider corridors")
            break
    raise ConfigError(
        f"Found no room with {options.obstacles} obstacles and corridors of {options.corridor_m} m in "
        f"{options.size_m[0]} x {options.size_m[1]} m: take fewer or smaller obstacles, or narrower corridors"
    )


def _obstacles(options: RandomRoom, random: np.random.Generator) -> tuple[Rectangle, ...]:
    found = []
    for _ in range(options.obstacles):
        length_m, width_m = random.uniform(*options.obstacle_m, size=2).round(2).tolist()
        x_m, y_m = (float(random.uniform(0.0, side)) for side in options.size_m)
        found.append(
            Rectangle(
                x_min_m=round(x_m - length_m / 2, 2),
                x_max_m=round(x_m - length_m / 2 + length_m, 2),
                y_min_m=round(y_m - width_m / 2, 2),
                y_max_m=round(y_m - width_m / 2 + width_m, 2),
            )
        )
    return tuple(found)


def _passages(room: Room, corridor_m: float) -> tuple[tuple[Floats, Floats], Integers]:
    """Return the x and y coordinates of cells, and the number of the region of each cell, (rows, columns).

    The centre of a disc as wide as the corridor can reach all cells of a region, but no other region. Region 0: none.
    """
    xs, ys = (np.arange(CELL_M / 2, side, CELL_M) for side in room.size_m)
    x, y = np.meshgrid(xs, ys)
    clear = np.minimum.reduce([x, y, room.size_m[0] - x, room.size_m[1] - y])
    for wall in room.obstacles:
        dx = np.maximum(np.maximum(wall.x_min_m - x, x - wall.x_max_m), 0.0)
        dy = np.maximum(np.maximum(wall.y_min_m - y, y - wall.y_max_m), 0.0)
        clear = np.minimum(clear, np.hypot(dx, dy))
    free = clear >= corridor_m / 2
    labels = np.zeros(free.shape, dtype=np.int64)
    label = 0
    while (left := free & (labels == 0)).any():
        label += 1
        region = np.zeros_like(free)
        region[tuple(np.argwhere(left)[0])] = True
        while (grown := _grown(region) & free).sum() > region.sum():
            region = grown
        labels[region] = label
    return (xs, ys), labels


def _grown(region: Flags) -> Flags:
    grown = region.copy()
    grown[1:] |= region[:-1]
    grown[:-1] |= region[1:]
    grown[:, 1:] |= region[:, :-1]
    grown[:, :-1] |= region[:, 1:]
    return grown


def _pose(
    centres: tuple[Floats, Floats], free: Indices, labels: Integers, random: np.random.Generator
) -> tuple[PoseDeg, int]:
    row, column = free[int(random.integers(len(free)))].tolist()
    yaw_deg = round(float(random.uniform(-180.0, 180.0)), 1)
    xs, ys = centres
    pose = PoseDeg(x_m=round(float(xs[column]), 3), y_m=round(float(ys[row]), 3), yaw_deg=yaw_deg)
    return pose, int(labels[row, column])


def _scenario(options: RandomRoom, seed: int, room: Room, start: PoseDeg, box: PoseDeg, goal: PoseDeg) -> Scenario:
    return Scenario(
        name=f"random-{seed}",
        description=f"A random room: seed {seed}, {options.obstacles} obstacles, corridors of {options.corridor_m} m",
        room=room,
        start=start,
        box=Box(pose=box, mass_kg=options.mass_kg, friction=options.friction),
        goal=Goal(
            pose=goal,
            position_tolerance_m=options.position_tolerance_m,
            angle_tolerance_deg=options.angle_tolerance_deg,
        ),
        randomization=Randomization(box_xy_m=options.box_xy_m, box_yaw_deg=options.box_yaw_deg),
    )


def _is_worth_it(scenario: Scenario, options: RandomRoom) -> bool:
    """Return whether the distances to walk and to push are long enough, and everything has its space."""
    start, box, goal = scenario.start.pose(), scenario.box.pose.pose(), scenario.goal.pose.pose()
    if _apart_m(start, box) < LEAST_WALK_M or _apart_m(box, goal) < options.push_m:
        return False
    try:
        check_scenario(scenario)
    except ScenarioError:
        return False
    return True


def _apart_m(a: Pose2, b: Pose2) -> float:
    return hypot(a.x_m - b.x_m, a.y_m - b.y_m)
