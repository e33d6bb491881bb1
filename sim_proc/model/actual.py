"""The robot and the floor as they are in an episode, where they differ from what control takes them to be."""

from collections.abc import Iterator
from math import ceil, hypot
from typing import Any, Final

import numpy as np
from msgspec.structs import replace

from legpush.realism.reality import TILES_STREAM, Reality
from legpush.scenarios.start import drawn_poses
from legpush.scene.robot import RobotSpec
from legpush.scene.robot_body import Joint
from legpush.scene.scenario import Scenario
from sim_proc.headless import mujoco
from sim_proc.model.collisions import FLOOR, FOOT_SOLREF, contact

PAYLOAD_HALF_M: Final = 0.06
"""Half the side of the cube that carries the payload."""
PAYLOAD_RED: Final = (0.62, 0.20, 0.16, 1.0)
TILE_GREY: Final = (0.70, 0.72, 0.75, 1.0)
GROUND: Final = "ground"
"""The body of the floor, if this has tiles."""
TILE_DEPTH_M: Final = 0.05
"""How far a tile reaches below the floor."""
LEVEL_M: Final = 0.05
"""How far beyond the feet, and beyond the corners of the box, the floor is level at the start."""
LEAST_TILE_M: Final = 1e-4
"""A tile that is lower is level with the floor."""


def actual_robot(robot: RobotSpec, reality: Reality) -> RobotSpec:
    """The robot with the strength and the friction that it really has."""
    joints, share = robot.joints, reality.motor_strength
    if share != 1.0:
        names = joints.__struct_fields__
        joints = replace(joints, **{name: _of_strength(getattr(joints, name), share) for name in names})
    legs = robot.legs if reality.foot_friction is None else replace(robot.legs, foot_friction=reality.foot_friction)
    return replace(robot, joints=joints, legs=legs)


def _of_strength(joint: Joint, share: float) -> Joint:
    """A joint whose servo has a share of its gains and torques."""
    return replace(
        joint,
        position_gain_n_m_rad=joint.position_gain_n_m_rad * share,
        velocity_gain_n_m_s_rad=joint.velocity_gain_n_m_s_rad * share,
        max_torque_n_m=joint.max_torque_n_m * share,
        torque_by_angle=tuple((angle, torque * share) for angle, torque in joint.torque_by_angle),
    )


def burden(spec: mujoco.MjSpec, reality: Reality) -> None:
    """Move the trunk's centre of mass, load the trunk, and let the joints rub, as they do in an episode."""
    trunk = spec.body("trunk")
    trunk.ipos = [place + offset for place, offset in zip(trunk.ipos, reality.com_offset_m, strict=True)]
    if reality.joint_friction_n_m > 0.0:
        for joint in spec.joints:
            if joint.type == mujoco.mjtJoint.mjJNT_HINGE:
                joint.frictionloss = reality.joint_friction_n_m
    if reality.payload_kg > 0.0:
        payload = trunk.add_body(name="payload", pos=reality.payload_m)
        payload.add_geom(
            name="payload",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[PAYLOAD_HALF_M] * 3,
            mass=reality.payload_kg,
            rgba=PAYLOAD_RED,
            contype=0,
            conaffinity=0,
        )


def add_tiles(body: mujoco.MjsBody, scenario: Scenario, reality: Reality) -> tuple[str, ...]:
    """Lay the tiles of an episode; return the names of those that rise above the floor."""
    names: list[str] = []
    friction = actual_robot(scenario.robot, reality).legs.foot_friction
    touched: dict[str, Any] = FLOOR | contact(friction, priority=1) | {"solref": FOOT_SOLREF}
    for x_m, y_m, top_m in tiles(scenario, reality):
        half = (top_m + TILE_DEPTH_M) / 2
        names.append(f"tile_{len(names)}")
        body.add_geom(
            name=names[-1],
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=[x_m, y_m, top_m - half],
            size=[reality.tile_size_m / 2, reality.tile_size_m / 2, half],
            rgba=TILE_GREY,
            **touched,
        )
    return tuple(names)


def tiles(scenario: Scenario, reality: Reality) -> Iterator[tuple[float, float, float]]:
    """Centre and height of each tile that rises above the floor, [m].

    Where the feet and the box are at the start there is none, so that the episode begins on a level floor.
    """
    if reality.tile_height_m < LEAST_TILE_M:
        return
    side = reality.tile_size_m
    n_x, n_y = (ceil(extent / side) for extent in scenario.room.size_m)
    heights = np.random.default_rng([reality.seed, TILES_STREAM]).uniform(0.0, reality.tile_height_m, (n_x, n_y))
    trunk, box = drawn_poses(scenario, reality.seed)
    stance = scenario.robot.stance
    level = (
        (trunk, stance.foot_circle_m + scenario.robot.legs.foot_radius_m + LEVEL_M),
        (box, hypot(*scenario.box.size_m[:2]) / 2 + LEVEL_M),
    )
    for i, j in np.ndindex(n_x, n_y):
        x, y = (i + 0.5) * side, (j + 0.5) * side
        away = [
            hypot(max(abs(x - place.x_m) - side / 2, 0.0), max(abs(y - place.y_m) - side / 2, 0.0)) - radius
            for place, radius in level
        ]
        if min(away) > 0.0 and heights[i, j] >= LEAST_TILE_M:
            yield x, y, float(heights[i, j])
