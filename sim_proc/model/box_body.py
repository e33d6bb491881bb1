"""The box as a body of the MuJoCo model, in each of its shapes."""

from math import atan2, cos, sin
from typing import Any, Final

from legpush.scene.scenario import Box
from sim_proc.headless import mujoco
from sim_proc.model.collisions import BOX, contact

CARDBOARD: Final = (0.72, 0.53, 0.35, 1.0)
MARK: Final = (0.13, 0.14, 0.16, 1.0)
MARK_HALF_WIDTH_M: Final = 0.012
LOAD_SHARE: Final = 0.05
"""Radius of the load that moves the centre of mass, as a share of the shortest side."""


def add_box(spec: mujoco.MjSpec, box: Box) -> tuple[str, ...]:
    """Add the free body `box` with its origin in the middle of `size_m`; return the names of its colliding geoms."""
    body = spec.worldbody.add_body(name="box", pos=[0, 0, box.size_m[2] / 2])
    body.add_freejoint(name="box")
    names = []
    touched = BOX | contact(box.friction_with_robot, priority=1)
    for index, geom in enumerate(_geoms(spec, box)):
        names.append("box" if index == 0 else f"box_{index}")
        body.add_geom(name=names[-1], rgba=CARDBOARD, **touched, **geom)
    if (share := box.load_share) > 0.0:
        body.add_geom(
            name="box_load",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[LOAD_SHARE * min(box.size_m), 0.0, 0.0],
            pos=[com - part + part / share for com, part in zip(box.com_m, box.com_offset_m, strict=True)],
            mass=share * box.mass_kg,
            rgba=MARK,
            contype=0,
            conaffinity=0,
        )
    body.add_geom(
        name="box_heading",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        mass=0.0,
        rgba=MARK,
        contype=0,
        conaffinity=0,
        **_mark(box),
    )
    return tuple(names)


def _geoms(spec: mujoco.MjSpec, box: Box) -> list[dict[str, Any]]:
    """Geoms that make up the shape. Their masses add up to the mass of the box without its load."""
    mass_kg = box.mass_kg * (1.0 - box.load_share)
    length, width, height = box.size_m
    x, y, z = length / 2, width / 2, height / 2
    cuboid = mujoco.mjtGeom.mjGEOM_BOX
    match box.shape:
        case "cuboid":
            return [{"type": cuboid, "size": [x, y, z], "mass": mass_kg}]
        case "cylinder":
            return [{"type": mujoco.mjtGeom.mjGEOM_CYLINDER, "size": [x, z, 0.0], "mass": mass_kg}]
        case "wedge":
            rear_top = [[-x, -y, z], [-x, y, z]]
            bottom = [[-x, -y, -z], [-x, y, -z], [x, -y, -z], [x, y, -z]]
            spec.add_mesh(name="wedge", uservert=[value for corner in rear_top + bottom for value in corner])
            return [{"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": "wedge", "mass": mass_kg}]
        case "l_shape":
            rear = {"type": cuboid, "size": [x / 2, y, z], "pos": [-x / 2, 0.0, 0.0], "mass": mass_kg * 2 / 3}
            left = {"type": cuboid, "size": [x / 2, y / 2, z], "pos": [x / 2, y / 2, 0.0], "mass": mass_kg / 3}
            return [rear, left]


def _mark(box: Box) -> dict[str, Any]:
    """A line on the front half of the upper side that shows people the heading of the box."""
    length, width, height = box.size_m
    flat = [length / 4, MARK_HALF_WIDTH_M, 0.002]
    if box.shape == "wedge":
        pitch = atan2(height, length)
        along = [length / 4 / cos(pitch), *flat[1:]]
        return {"size": along, "pos": [length / 4, 0.0, -height / 4], "quat": [cos(pitch / 2), 0, sin(pitch / 2), 0]}
    side = width / 4 if box.shape == "l_shape" else 0.0
    return {"size": flat, "pos": [length / 4, side, height / 2]}
