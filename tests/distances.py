"""Distances of places to what is occupied."""

from legpush.geometry import Pose2
from legpush.scene.clearance import Occupied
from legpush.scene.occupancy import OccupancyGrid


def clearance_at(grid: OccupancyGrid, pose: Pose2) -> float:
    """Return the exact distance of a position to occupied squares; the outside is occupied."""
    return Occupied(grid).nearest(pose.xy()[None]).distance_m
