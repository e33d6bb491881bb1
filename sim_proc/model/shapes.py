"""The looks of a MuJoCo model as plain numbers: a tree of bodies and the shapes on them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from legpush.arrays import Floats
from legpush.realism.reality import AS_ASSUMED, Reality
from legpush.scene.scenario import Scenario
from sim_proc.headless import mujoco
from sim_proc.model.world import build_model

Kind = Literal["plane", "sphere", "capsule", "cylinder", "box", "mesh"]

KINDS: Final[dict[int, Kind]] = {
    int(mujoco.mjtGeom.mjGEOM_PLANE): "plane",
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
    int(mujoco.mjtGeom.mjGEOM_MESH): "mesh",
}
FLOOR_GREY: Final = (0.83, 0.84, 0.86, 1.0)
"""Colour of the floor, instead of its texture."""


@dataclass(frozen=True, kw_only=True)
class Shape:
    """A geom of a body."""

    name: str
    kind: Kind
    position_m: Floats
    """Position in the frame of the body, (3,). The quaternion is in the same frame."""
    quaternion_wxyz: Floats
    size_m: Floats
    """MuJoCo's half sizes, (3,). A sphere has a radius, a capsule or cylinder a radius and half a length along z."""
    rgba: tuple[float, float, float, float]
    triangles_m: Floats
    """Triangles of a mesh in the frame of the shape, (n, 3, 3); none for other kinds."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """A body of the model."""

    name: str
    parent: str
    """Name of the body it hangs on; `world` if it stands or moves freely."""
    position_m: Floats
    """Position in the frame of the parent, (3,), with a hinge at angle 0. A free body is where `qpos` says instead."""
    quaternion_wxyz: Floats
    joint: Literal["none", "hinge", "free"]
    axis: Floats
    """Axis of a hinge, (3,), through the origin of the body."""
    qpos: int
    """First column of the joint in `qpos`; -1 without a joint."""
    shapes: tuple[Shape, ...]


def parts_of(scenario: Scenario, reality: Reality = AS_ASSUMED) -> list[Part]:
    """All bodies of a scenario's world: the world itself first, and each after its parent."""
    return parts_of_model(build_model(scenario, reality))


def parts_of_model(model: mujoco.MjModel) -> list[Part]:
    """The same for a compiled model."""
    return [_part(model, body) for body in range(model.nbody)]


def _part(model: mujoco.MjModel, body: int) -> Part:
    joint, kind = int(model.body_jntadr[body]), "none"
    if joint >= 0:
        kind = "free" if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE else "hinge"
    return Part(
        name=model.body(body).name,
        parent=model.body(int(model.body_parentid[body])).name,
        position_m=model.body_pos[body].copy(),
        quaternion_wxyz=model.body_quat[body].copy(),
        joint=kind,  # type: ignore[arg-type]
        axis=model.jnt_axis[joint].copy() if kind == "hinge" else np.zeros(3),
        qpos=int(model.jnt_qposadr[joint]) if joint >= 0 else -1,
        shapes=tuple(_shapes(model, body)),
    )


def _shapes(model: mujoco.MjModel, body: int) -> Iterator[Shape]:
    first = int(model.body_geomadr[body])
    for geom in range(first, first + int(model.body_geomnum[body])):
        kind = KINDS[int(model.geom_type[geom])]
        rgba = FLOOR_GREY if kind == "plane" else tuple(map(float, model.geom_rgba[geom]))
        yield Shape(
            name=model.geom(geom).name,
            kind=kind,
            position_m=model.geom_pos[geom].copy(),
            quaternion_wxyz=model.geom_quat[geom].copy(),
            size_m=model.geom_size[geom].copy(),
            rgba=rgba,  # type: ignore[arg-type]
            triangles_m=_triangles(model, int(model.geom_dataid[geom])) if kind == "mesh" else np.empty((0, 3, 3)),
        )


def _triangles(model: mujoco.MjModel, mesh: int) -> Floats:
    vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]].astype(np.float64)
    faces = model.mesh_face[model.mesh_faceadr[mesh] :][: model.mesh_facenum[mesh]]
    triangles: Floats = vertices[faces]
    return triangles
