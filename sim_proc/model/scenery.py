"""Surroundings of the robot in the MuJoCo model: floor, light, walls and goal markers."""

from math import cos, radians, sin
from typing import Final

import numpy as np

from legpush.scene.scenario import Box, Goal, Room, Scenario
from sim_proc.headless import mujoco
from sim_proc.model.collisions import FLOOR, WALL

WALL_GREY: Final = (0.62, 0.65, 0.69, 1.0)
APPEARED_OCHRE: Final = (0.80, 0.58, 0.30, 1.0)
GOAL_GREEN: Final = (0.12, 0.65, 0.32, 0.9)
LEAST_SQUARE_M: Final = 4.0
SQUARES_ALONG: Final = 5
"""Least side of the squares that walls are grouped by, and how many squares lie along the room at most."""
MOST_ALONE: Final = 16
"""Most walls that are groups of their own since they are longer than a square."""
UNMOVED: Final = {"explicitinertial": True, "mass": 1.0, "inertia": (1.0, 1.0, 1.0)}
"""Mass and inertia of bodies that nothing moves, so that they do not matter. They are stated since MuJoCo refuses the
rounded inertia of some thin walls.
"""

Group = tuple[int, ...]
"""A square of the floor by its row and column, or a wall alone."""


def add_scenery(spec: mujoco.MjSpec, scenario: Scenario, *, ground: str | None = None) -> None:
    """Add floor, light, walls and goal markers to a model. The floor is a body of its own with the name `ground`."""
    _add_looks(spec)
    floor_x, floor_y = scenario.room.size_m
    body = spec.worldbody if ground is None else spec.worldbody.add_body(name=ground, **UNMOVED)
    body.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[floor_x / 2, floor_y / 2, 0.1],
        pos=[floor_x / 2, floor_y / 2, 0.0],
        material="floor",
        **FLOOR,
    )
    _add_walls(spec, scenario.room)
    _add_goal(spec, scenario.goal, scenario.box)


def _add_looks(spec: mujoco.MjSpec) -> None:
    """Add materials and light, and set the quality of rendering."""
    spec.visual.global_.offwidth = 1920
    spec.visual.global_.offheight = 1080
    spec.visual.headlight.ambient[:] = (0.35, 0.35, 0.35)
    spec.visual.headlight.diffuse[:] = (0.35, 0.35, 0.35)
    spec.visual.quality.shadowsize = 4096
    spec.visual.quality.offsamples = 2
    spec.add_texture(
        name="tiles",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=[0.86, 0.87, 0.88],
        rgb2=[0.80, 0.81, 0.83],
        markrgb=[0.74, 0.75, 0.77],
        width=256,
        height=256,
    )
    floor = spec.add_material(name="floor", texrepeat=[1.0, 1.0], texuniform=True)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.93, 0.95, 0.98],
        rgb2=[0.72, 0.79, 0.87],
        width=64,
        height=384,
    )
    spec.worldbody.add_light(
        name="sun",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=[0, 0, 8],
        dir=[-0.35, 0.45, -1.0],
        diffuse=[0.55, 0.55, 0.55],
        castshadow=True,
    )


def wall_name(index: int) -> str:
    """Name of an obstacle's geom, and of its body if the obstacle appears later."""
    return f"wall_{index}"


def _add_walls(spec: mujoco.MjSpec, room: Room) -> None:
    """Add the walls of a room.

    A wall that appears later is a mocap body, so that the physics can keep it out of the way until then. In the model
    it stands in its final place. The other walls are geoms of bodies that cannot move, one for each group of walls near
    each other: MuJoCo passes over a body that is far away as a whole, so walls far from robot and box cost little.
    """
    bodies: dict[Group, mujoco.MjsBody] = {}
    groups = wall_groups(room)
    for index, wall in enumerate(room.obstacles):
        half = [(wall.x_max_m - wall.x_min_m) / 2, (wall.y_max_m - wall.y_min_m) / 2, room.wall_height_m / 2]
        centre = [wall.x_min_m + half[0], wall.y_min_m + half[1], half[2]]
        later = index not in groups
        if later:
            body = _add_later_body(spec, wall_name(index), centre)
        else:
            if groups[index] not in bodies:
                bodies[groups[index]] = spec.worldbody.add_body(name=f"walls_{len(bodies)}", **UNMOVED)
            body = bodies[groups[index]]
        body.add_geom(
            name=wall_name(index),
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=half,
            pos=[0.0, 0.0, 0.0] if later else centre,
            rgba=APPEARED_OCHRE if later else WALL_GREY,
            **WALL,
        )


def wall_groups(room: Room) -> dict[int, Group]:
    """The groups of the walls that are there from the start, by the index of the obstacle.

    A group is a square of the floor with the walls whose centres lie in it. Some of the longest walls are groups of
    their own. There are few groups: each costs time at every step.
    """
    walls = {index: wall for index, wall in enumerate(room.obstacles) if wall.appears_at_s == 0.0}
    if not walls:
        return {}
    x_min, x_max, y_min, y_max = np.array([wall.sides_m() for wall in walls.values()]).T
    centres = np.column_stack([x_min + x_max, y_min + y_max]) / 2
    side_m = max(LEAST_SQUARE_M, float(np.ptp(centres, axis=0).max()) / SQUARES_ALONG)
    length_m = np.maximum(x_max - x_min, y_max - y_min)
    alone = [row for row in np.argsort(-length_m, kind="stable")[:MOST_ALONE].tolist() if length_m[row] > side_m]
    squares = [(int(x), int(y)) for x, y in np.floor((centres - centres.min(axis=0)) / side_m).tolist()]
    return {index: (row,) if row in alone else squares[row] for row, index in enumerate(walls)}


def _add_later_body(spec: mujoco.MjSpec, name: str, centre: list[float]) -> mujoco.MjsBody:
    """Add the body of a wall that appears later."""
    return spec.worldbody.add_body(name=name, mocap=True, pos=centre, **UNMOVED)


def _add_goal(spec: mujoco.MjSpec, goal: Goal, box: Box) -> None:
    """Add the outline of the box at its goal pose, with a line for its heading. Nothing touches it."""
    length, width, _ = box.size_m
    yaw = radians(goal.pose.yaw_deg)
    body = spec.worldbody.add_body(
        name="goal", pos=[goal.pose.x_m, goal.pose.y_m, 0.0], quat=[cos(yaw / 2), 0, 0, sin(yaw / 2)]
    )
    line = 0.012
    marks = {
        "goal_front": ([length / 2, 0.0], [line, width / 2]),
        "goal_rear": ([-length / 2, 0.0], [line, width / 2]),
        "goal_left": ([0.0, width / 2], [length / 2, line]),
        "goal_right": ([0.0, -width / 2], [length / 2, line]),
        "goal_heading": ([length / 4, 0.0], [length / 4, line]),
    }
    for name, (centre, half) in marks.items():
        body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=[*centre, 0.001],
            size=[*half, 0.002],
            rgba=GOAL_GREEN,
            contype=0,
            conaffinity=0,
        )
