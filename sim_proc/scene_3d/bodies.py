"""The bodies of a scenario's MuJoCo model as meshes, and their poses for given joint positions.

The meshes are coarse, because a page without a GPU spends most of its time on their corners.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import trimesh

from legpush.arrays import Floats
from legpush.messages.stepping import Appearance
from legpush.realism.reality import AS_ASSUMED, Reality
from legpush.scene.scenario import Scenario
from sim_proc.headless import mujoco
from sim_proc.model.scenery import wall_name
from sim_proc.model.shapes import Part, Shape, parts_of_model
from sim_proc.model.world import build_model

AROUND: Final = 14
"""Corners around a sphere or capsule; a cylinder has twice as many."""


@dataclass(frozen=True, kw_only=True)
class Body:
    """A rigid part of the scene."""

    name: str
    index: int
    """Index of the body in the arrays of `Bodies.poses`."""
    mesh: Any
    """A `trimesh.Trimesh` with colours, in the frame of the body."""
    appears: bool
    """Whether it is an obstacle that appears later."""


class Bodies:
    """The bodies of one scenario."""

    def __init__(self, scenario: Scenario, reality: Reality = AS_ASSUMED) -> None:
        """Compile the model and build its meshes."""
        self._model = build_model(scenario, reality)
        self._data = mujoco.MjData(self._model)
        later = (index for index, wall in enumerate(scenario.room.obstacles) if wall.appears_at_s > 0.0)
        self._appearing = {wall_name(index): index for index in later}
        self.all = tuple(
            Body(name=part.name, index=index, mesh=mesh_of(part), appears=part.name in self._appearing)
            for index, part in enumerate(parts_of_model(self._model))
            if any(map(_is_seen, part.shapes))
        )
        """The visible bodies. The floor is not among them."""

    def poses(self, qpos: Floats) -> tuple[Floats, Floats]:
        """Positions (n, 3) and quaternions (n, 4; w, x, y, z) of all bodies, world frame."""
        self._data.qpos[:] = qpos
        mujoco.mj_kinematics(self._model, self._data)
        return self._data.xpos.copy(), self._data.xquat.copy()

    def is_there(self, body: Body, appeared: tuple[Appearance, ...], tick: float) -> bool:
        """Whether a body is visible at a tick, given what has appeared by that tick or a later one."""
        return not body.appears or any(
            each.obstacle == self._appearing[body.name] and each.tick <= tick for each in appeared
        )


def mesh_of(part: Part) -> trimesh.Trimesh:
    """The visible shapes of a body as one mesh, in the frame of the body."""
    mesh = trimesh.util.concatenate([_mesh(shape) for shape in part.shapes if _is_seen(shape)])
    if not isinstance(mesh, trimesh.Trimesh):
        raise TypeError(f"Expected a mesh of {part.name}, got {type(mesh).__name__}")
    return mesh


def _is_seen(shape: Shape) -> bool:
    return shape.kind != "plane" and shape.rgba[3] > 0.0


def _mesh(shape: Shape) -> trimesh.Trimesh:
    size = shape.size_m
    match shape.kind:
        case "sphere":
            mesh = trimesh.creation.uv_sphere(radius=size[0], count=[AROUND // 2, AROUND])
        case "capsule":
            mesh = trimesh.creation.capsule(radius=size[0], height=2 * size[1], count=[AROUND // 2, AROUND])
        case "cylinder":
            mesh = trimesh.creation.cylinder(radius=size[0], height=2 * size[1], sections=2 * AROUND)
        case "box":
            mesh = trimesh.creation.box(extents=2 * size)
        case _:
            corners = shape.triangles_m.reshape(-1, 3)
            mesh = trimesh.Trimesh(vertices=corners, faces=np.arange(len(corners)).reshape(-1, 3))
    mesh.apply_transform(_pose(shape))
    colors = np.tile((255 * np.array(shape.rgba)).astype(np.uint8), (len(mesh.vertices), 1))
    mesh.visual = trimesh.visual.ColorVisuals(vertex_colors=colors)
    return mesh


def _pose(shape: Shape) -> Floats:
    """The transform from the frame of a shape to that of its body, (4, 4)."""
    matrix = np.eye(4)
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, shape.quaternion_wxyz)
    matrix[:3, :3], matrix[:3, 3] = rotation.reshape(3, 3), shape.position_m
    return matrix
