"""Queries with the body of the robot, and a measure of its clearance that shares nothing with the planner."""

from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
from msgspec.structs import replace
from shapely import MultiPolygon, Polygon, box
from shapely.affinity import rotate, translate

from legpush.arrays import Floats
from legpush.geometry import ORIGIN
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.footprints import Footprint, robot_footprint
from legpush.scene.occupancy import OccupancyGrid
from tests.planner.maps import query
from tests.robots import ROBOT

BODY = robot_footprint(ROBOT, ORIGIN)
BODY_M = 0.05
"""Clearance of the body."""


def body_query(
    grid: OccupancyGrid, start: tuple[float, ...], goal: tuple[float, ...], **changes: Any
) -> TrunkPathQuery:
    """A query for the body of the robot."""
    return replace(query(grid, start, goal), body=BODY, body_clearance_m=BODY_M, **changes)


def poses_of(plan: Plan) -> Floats:
    """The waypoints of a plan, with headings that do not jump, (n, 3)."""
    poses = np.array([(waypoint.x_m, waypoint.y_m, waypoint.yaw_rad) for waypoint in plan.waypoints])
    poses[:, 2] = np.unwrap(poses[:, 2])
    return poses


def least_distance_m(grid: OccupancyGrid, body: Footprint, poses: Floats) -> float:
    """Distance of the body from what is occupied and from the outside, in poses (n, 3) and at places in between."""
    cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)
    (x_m, y_m), side_m = grid.origin_m, grid.resolution_m
    squares = MultiPolygon(
        [
            box(x_m + column * side_m, y_m + row * side_m, x_m + (column + 1) * side_m, y_m + (row + 1) * side_m)
            for row, column in np.argwhere(cells).tolist()
        ]
    )
    room = box(x_m, y_m, *grid.far_corner_m())
    least_m = np.inf
    for begin, end in pairwise(poses):
        for share in (0.0, 0.25, 0.5, 0.75, 1.0):
            shape = placed(body, *(begin + share * (end - begin)).tolist())
            inside_m = room.exterior.distance(shape) if room.contains(shape) else 0.0
            least_m = min(least_m, inside_m, squares.distance(shape) if len(cells.nonzero()[0]) else np.inf)
    return float(least_m)


def placed(body: Footprint, x_m: float, y_m: float, yaw_rad: float) -> Polygon:
    """The body of a trunk at a pose."""
    turned = rotate(Polygon(body.corners()), 180.0 * yaw_rad / pi, origin=(0.0, 0.0))
    return translate(turned, x_m, y_m)
