"""Shapes, lines and arrows as scene entities of Foxglove."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from foxglove.messages import (
    ArrowPrimitive,
    Color,
    CubePrimitive,
    CylinderPrimitive,
    LinePrimitive,
    LinePrimitiveLineType,
    Point3,
    Pose,
    Quaternion,
    SceneEntity,
    SpherePrimitive,
    Timestamp,
    TriangleListPrimitive,
    Vector3,
)

from legpush.arrays import Floats
from legpush.scene.conventions import LEGS, LOADED_N
from sim_proc.export.transforms import WORLD, product, turn_to
from sim_proc.model.shapes import Part, Shape

Rgba = tuple[float, float, float, float]

FLOOR_THICKNESS_M: Final = 0.01
TRUNK_ORANGE: Final[Rgba] = (0.90, 0.55, 0.10, 0.9)
BOX_BROWN: Final[Rgba] = (0.45, 0.30, 0.18, 0.9)
TREE_GREY: Final[Rgba] = (0.45, 0.50, 0.58, 0.7)
FORCE_RED: Final[Rgba] = (0.80, 0.15, 0.15, 0.9)
SUPPORT_BLUE: Final[Rgba] = (0.16, 0.36, 0.72, 0.9)
COM_GREEN: Final[Rgba] = (0.10, 0.60, 0.30, 1.0)
ZMP_VIOLET: Final[Rgba] = (0.55, 0.20, 0.65, 1.0)
METRES_PER_NEWTON: Final = 0.002
"""Scale of the arrows of forces."""
LINE_M: Final = 0.012
"""Thickness of lines."""
ABOVE_FLOOR_M: Final = 0.004
"""Height at which lines on the floor are drawn."""


def pose(position_m: Floats, quaternion_wxyz: Floats) -> Pose:
    """A pose in the form of Foxglove."""
    return Pose(position=vector(position_m), orientation=quaternion(quaternion_wxyz))


def vector(position_m: Floats) -> Vector3:
    """A vector (3,) in the form of Foxglove."""
    x, y, z = map(float, position_m)
    return Vector3(x=x, y=y, z=z)


def quaternion(quaternion_wxyz: Floats) -> Quaternion:
    """A quaternion (4,) in the form of Foxglove, whose w comes last."""
    w, x, y, z = map(float, quaternion_wxyz)
    return Quaternion(x=x, y=y, z=z, w=w)


def body_entity(part: Part, time: Timestamp) -> SceneEntity:
    """All shapes of a body. They move with the frame that has the name of the body."""
    cubes, spheres, cylinders, triangles = [], [], [], []
    for shape in part.shapes:
        color, place = _color(shape.rgba), pose(shape.position_m, shape.quaternion_wxyz)
        match shape.kind:
            case "box":
                cubes.append(CubePrimitive(pose=place, size=vector(2 * shape.size_m), color=color))
            case "plane":
                x, y = 2 * shape.size_m[:2]
                below = pose(shape.position_m - np.array([0.0, 0.0, FLOOR_THICKNESS_M / 2]), shape.quaternion_wxyz)
                size = Vector3(x=float(x), y=float(y), z=FLOOR_THICKNESS_M)
                cubes.append(CubePrimitive(pose=below, size=size, color=color))
            case "sphere":
                spheres.append(_sphere(shape.position_m, float(shape.size_m[0]), color))
            case "cylinder" | "capsule":
                radius, half = map(float, shape.size_m[:2])
                size = Vector3(x=2 * radius, y=2 * radius, z=2 * half)
                cylinders.append(CylinderPrimitive(pose=place, size=size, bottom_scale=1.0, top_scale=1.0, color=color))
                if shape.kind == "capsule":
                    spheres += [_sphere(end, radius, color) for end in _ends(shape)]
            case "mesh":
                points = [_point(corner) for corner in shape.triangles_m.reshape(-1, 3)]
                triangles.append(TriangleListPrimitive(pose=place, points=points, color=color))
    return SceneEntity(
        id=part.name,
        frame_id=part.name,
        frame_locked=True,
        timestamp=time,
        cubes=cubes,
        spheres=spheres,
        cylinders=cylinders,
        triangles=triangles,
    )


def line_entity(name: str, points_m: Floats, rgba: Rgba, time: Timestamp, *, pairs: bool = False) -> SceneEntity:
    """A line on the floor through points (n, 2), or with `pairs` a separate line for every two points."""
    kind = LinePrimitiveLineType.LineList if pairs else LinePrimitiveLineType.LineStrip
    line = LinePrimitive(
        type=kind,
        thickness=LINE_M,
        points=[Point3(x=float(x), y=float(y), z=ABOVE_FLOOR_M) for x, y in points_m],
        color=_color(rgba),
    )
    return SceneEntity(id=name, frame_id=WORLD, timestamp=time, lines=[line])


def feet_entities(tips_m: Floats, forces_n: Floats, com_m: Floats, zmp_m: Floats, time: Timestamp) -> list[SceneEntity]:
    """Forces on the feet (4, 3), the support polygon of the feet that carry load, and CoM and ZMP on the floor."""
    arrows = [
        ArrowPrimitive(
            pose=pose(tip, turn_to(force)),
            shaft_length=METRES_PER_NEWTON * float(np.linalg.norm(force)),
            shaft_diameter=0.012,
            head_length=0.03,
            head_diameter=0.03,
            color=_color(FORCE_RED),
        )
        for tip, force in zip(tips_m, forces_n, strict=True)
        if np.linalg.norm(force) >= LOADED_N
    ]
    standing = tips_m[forces_n[:, 2] >= LOADED_N, :2]
    if len(standing) >= 3:
        away = standing - standing.mean(axis=0)
        standing = standing[np.argsort(np.arctan2(away[:, 1], away[:, 0]))]
        standing = np.concatenate([standing, standing[:1]])
    dots = [
        _sphere(np.array([*com_m[:2], ABOVE_FLOOR_M]), 0.015, _color(COM_GREEN)),
        _sphere(np.array([*zmp_m, ABOVE_FLOOR_M]), 0.012, _color(ZMP_VIOLET)),
    ]
    return [
        SceneEntity(id="forces", frame_id=WORLD, timestamp=time, arrows=arrows),
        line_entity("support", standing, SUPPORT_BLUE, time),
        SceneEntity(id="com_zmp", frame_id=WORLD, timestamp=time, spheres=dots),
    ]


def robot_bodies() -> frozenset[str]:
    """Names of the bodies of the robot."""
    return frozenset({"trunk", *(f"{leg}_{link}" for leg in LEGS for link in ("hip", "upper", "lower"))})


def _ends(shape: Shape) -> list[Floats]:
    """Centres of the two half spheres of a capsule, in the frame of the body."""
    q = shape.quaternion_wxyz[None]
    along = product(product(q, np.array([[0.0, 0.0, 0.0, 1.0]])), q * np.array([1.0, -1.0, -1.0, -1.0]))[0, 1:]
    return [shape.position_m + side * shape.size_m[1] * along for side in (-1.0, 1.0)]


def _sphere(centre_m: Floats, radius_m: float, color: Color) -> SpherePrimitive:
    size = Vector3(x=2 * radius_m, y=2 * radius_m, z=2 * radius_m)
    return SpherePrimitive(pose=pose(centre_m, np.array([1.0, 0.0, 0.0, 0.0])), size=size, color=color)


def _point(position_m: Floats) -> Point3:
    x, y, z = map(float, position_m)
    return Point3(x=x, y=y, z=z)


def _color(rgba: Sequence[float]) -> Color:
    r, g, b, a = rgba
    return Color(r=r, g=g, b=b, a=a)
