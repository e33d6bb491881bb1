"""Pushing a face other than the rear one: the same push of the same box, seen from another side.

What is pushed has a frame of its own: its origin is the box's centre and its x axis the pushing direction, which is the
box's x axis for the rear face, and turned by a quarter, a half or three quarters for the others.
"""

from math import pi
from typing import Final

from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.scene.names import BoxShape, Face
from legpush.scene.scenario import Box

FACES: Final[tuple[Face, ...]] = ("rear", "right", "front", "left")
TURN_RAD: Final[dict[Face, float]] = {"rear": 0.0, "right": pi / 2, "front": pi, "left": -pi / 2}
"""From the box's x axis to the direction in which a push on the face moves it."""
PUSHABLE: Final[dict[BoxShape, tuple[Face, ...]]] = {
    "cuboid": FACES,
    "cylinder": FACES,
    "wedge": ("rear",),
    "l_shape": ("rear", "left"),
}
"""Faces that are upright and whole, so that a foot finds them where it expects them."""


def pushed_pose(pose: Pose2, face: Face) -> Pose2:
    """The pose of the frame that is pushed, of a box at `pose`."""
    return pose if face == "rear" else pose @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=TURN_RAD[face])


def pushed_box(box: Box, face: Face) -> Box:
    """The box with the size that it has in the frame that is pushed."""
    length_m, width_m, height_m = box.size_m
    return replace(box, size_m=(width_m, length_m, height_m)) if face in ("right", "left") else box
