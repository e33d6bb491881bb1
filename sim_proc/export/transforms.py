"""Frames of a world and their poses at each tick, in NumPy alone. Quaternions are (w, x, y, z)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from legpush.arrays import Floats
from sim_proc.model.shapes import Part

WORLD = "world"
"""Name of the frame of the world."""


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A frame and its poses in the frame of its parent."""

    name: str
    parent: str
    positions_m: Floats
    """(n, 3)"""
    quaternions_wxyz: Floats
    """(n, 4)"""


def moving_frames(parts: Sequence[Part], qpos: Floats) -> list[Frame]:
    """Frames that joints move, at each row of `qpos` (n, 26). Poses of free bodies are those in `qpos`, bit for bit."""
    return list(_moving(parts, qpos))


def standing_frames(parts: Sequence[Part]) -> list[Frame]:
    """Frames without a joint, except that of the world, with one row each."""
    return [
        Frame(
            name=part.name,
            parent=part.parent,
            positions_m=part.position_m[None],
            quaternions_wxyz=part.quaternion_wxyz[None],
        )
        for part in parts
        if part.joint == "none" and part.name != WORLD
    ]


def _moving(parts: Sequence[Part], qpos: Floats) -> Iterator[Frame]:
    for part in parts:
        if part.joint == "free":
            pose = qpos[:, part.qpos : part.qpos + 7]
            positions, quaternions = pose[:, :3], pose[:, 3:]
        elif part.joint == "hinge":
            half = qpos[:, part.qpos, None] / 2
            turn = np.concatenate([np.cos(half), np.sin(half) * part.axis], axis=1)
            positions = np.broadcast_to(part.position_m, (len(qpos), 3))
            quaternions = product(np.broadcast_to(part.quaternion_wxyz, (len(qpos), 4)), turn)
        else:
            continue
        yield Frame(name=part.name, parent=part.parent, positions_m=positions, quaternions_wxyz=quaternions)


def product(first: Floats, second: Floats) -> Floats:
    """The product of quaternions (n, 4), row by row: the rotation `second`, followed by `first`."""
    w, x, y, z = first.T
    a, b, c, d = second.T
    return np.column_stack(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ]
    )


def turn_to(direction: Floats) -> Floats:
    """A quaternion (4,) that turns the x axis into a direction (3,); the identity if the direction is zero."""
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        return np.array([1.0, 0.0, 0.0, 0.0])
    x, y, z = direction / length
    if x < -1.0 + 1e-12:
        return np.array([0.0, 0.0, 0.0, 1.0])
    turned = np.array([1.0 + x, 0.0, -z, y])
    turned /= np.linalg.norm(turned)
    return turned
