"""The pushed frame of a box: a push on any face is the same push, seen from another side.

The origin of the pushed frame is the centre of the box, and its x axis is the pushing direction. For the rear face, it
is the box's x axis; for the other faces, it is turned by a quarter, a half or three quarters.
"""

from math import pi
from typing import Final

from msgspec.structs import replace

from legpush.geometry import Point3, Pose2
from legpush.scene.names import BoxShape, Face
from legpush.scene.scenario import Box

FACES: Final[tuple[Face, ...]] = ("rear", "right", "front", "left")
TURN_RAD: Final[dict[Face, float]] = {"rear": 0.0, "right": pi / 2, "front": pi, "left": -pi / 2}
"""Angle from the box's x axis to the direction in which a push on the face moves the box."""
PUSHABLE: Final[dict[BoxShape, tuple[Face, ...]]] = {
    "cuboid": FACES,
    "cylinder": FACES,
    "wedge": ("rear",),
    "l_shape": ("rear", "left"),
}
"""Faces that are upright and whole, so that a foot meets them in the expected place."""


def face_beside(face: Face, n_quarters: int) -> Face:
    """Return the face that is reached by turning the pushing direction of a face by `n_quarters` to the left."""
    return FACES[(FACES.index(face) + n_quarters) % len(FACES)]


def pushed_pose(pose: Pose2, face: Face) -> Pose2:
    """Return the pose of the pushed frame of a box at `pose`."""
    return pose if face == "rear" else pose @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=TURN_RAD[face])


def pushed_box(box: Box, face: Face) -> Box:
    """Return the box with its size in the pushed frame. For its centre of mass there, see `pushed_com_m`."""
    length_m, width_m, height_m = box.size_m
    size_m = (width_m, length_m, height_m) if face in ("right", "left") else box.size_m
    return replace(box, size_m=size_m, com_offset_m=(0.0, 0.0, 0.0))


def pushed_com_m(box: Box, face: Face) -> Point3:
    """Return the centre of mass in the pushed frame."""
    x_m, y_m, z_m = box.com_m
    match face:
        case "rear":
            return x_m, y_m, z_m
        case "right":
            return y_m, -x_m, z_m
        case "front":
            return -x_m, -y_m, z_m
        case "left":
            return -y_m, x_m, z_m
