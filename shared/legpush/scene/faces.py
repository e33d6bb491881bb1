"""The pushed frame of a box: a push on any face is the same push, seen from another side.

The origin of the pushed frame is the centre of the box, and its x axis is the pushing direction. For the rear face, it
is the box's x axis; for the other faces, it is turned by a quarter, a half or three quarters.
"""

from math import pi
from typing import Final

from msgspec.structs import replace

from legpush.geometry import Pose2
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


def pushed_pose(pose: Pose2, face: Face) -> Pose2:
    """Return the pose of the pushed frame of a box at `pose`."""
    return pose if face == "rear" else pose @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=TURN_RAD[face])


def pushed_box(box: Box, face: Face) -> Box:
    """Return the box with its size in the pushed frame."""
    length_m, width_m, height_m = box.size_m
    return replace(box, size_m=(width_m, length_m, height_m)) if face in ("right", "left") else box
