"""The two corners of the box that observation and reward look at: front left and front right."""

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import rectangle_corners, rotation_from_rpy, rpy_from_quaternion
from legpush.messages.stepping import BoxState
from legpush.scene.scenario import Box, Goal

FRONT = [0, 3]
"""Indices of front left and front right in `rectangle_corners`."""


def tracked_corners_m(state: BoxState, box: Box) -> Floats:
    """Upper front left and front right corner of the box, world frame, (2, 3)."""
    length_m, width_m, height_m = box.size_m
    corners_b = np.column_stack([rectangle_corners(length_m, width_m)[FRONT], np.full(2, height_m / 2)])
    rotation = rotation_from_rpy(*rpy_from_quaternion(state.orientation_wxyz))
    corners: Floats = np.array(state.position_m) + corners_b @ rotation.T
    return corners


def goal_corners_m(goal: Goal, box: Box) -> Floats:
    """The same corners of a box at its goal, on the floor, world frame, (2, 2)."""
    length_m, width_m, _ = box.size_m
    return goal.pose.pose().apply(rectangle_corners(length_m, width_m)[FRONT])
