"""Maps, queries, and a measure of clearance that shares nothing with the planner."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.plan_settings import Smoothing

CLEARANCE_M = 0.44
NOT_SMOOTHED = Smoothing(method="none", shorten=False)


def grid(cells: NDArray[Any], resolution_m: float = 0.1, origin_m: tuple[float, float] = (0.0, 0.0)) -> OccupancyGrid:
    """A grid of cells, (rows, columns), true where occupied."""
    n_rows, n_columns = cells.shape
    return OccupancyGrid(
        n_columns=n_columns,
        n_rows=n_rows,
        resolution_m=resolution_m,
        origin_m=origin_m,
        cells=cells.astype(np.uint8).tobytes(),
    )


def room(*blocks: tuple[float, float, float, float], size_m: tuple[float, float] = (8.0, 6.0)) -> OccupancyGrid:
    """A room of 0.1 m cells with blocks (x_min, x_max, y_min, y_max)."""
    cells = np.zeros((round(size_m[1] * 10), round(size_m[0] * 10)), dtype=np.bool_)
    for x_min, x_max, y_min, y_max in blocks:
        cells[round(y_min * 10) : round(y_max * 10), round(x_min * 10) : round(x_max * 10)] = True
    return grid(cells)


MAZE = room((0.0, 5.5, 1.9, 2.1), (2.5, 8.0, 3.9, 4.1))
"""Two walls between (1, 1) and (7, 5)."""


def gate(width_m: float) -> OccupancyGrid:
    """Two halves of a room, 20 by 10 m in cells of 0.02 m, joined by a gate at (10, 5)."""
    cells = np.zeros((500, 1000), dtype=np.bool_)
    cells[:, 490:510] = True
    half = round(width_m / 0.04)
    cells[250 - half : 250 + half, 490:510] = False
    return grid(cells, 0.02)


def random_room(rng: np.random.Generator) -> OccupancyGrid:
    """A room of 8 by 6 m with walls, blocks and pillars."""
    blocks = []
    for _ in range(rng.integers(2, 16)):
        x, y = rng.uniform(0.0, 8.0), rng.uniform(0.0, 6.0)
        width, height = rng.uniform(0.1, 2.5, 2) if rng.random() < 0.4 else rng.uniform(0.1, 0.5, 2)
        blocks.append((x, x + width, y, y + height))
    return room(*blocks)


def query(grid: OccupancyGrid, start: tuple[float, ...], goal: tuple[float, ...], **changes: Any) -> TrunkPathQuery:
    """A query from (x, y) or (x, y, yaw) to another, with defaults that `changes` replaces."""
    fields: dict[str, Any] = {
        "clearance_m": CLEARANCE_M,
        "planner": "rrt_connect",
        "seed": 0,
        "max_iterations": 20_000,
        "goal_bias": 0.05,
        "step_m": 0.5,
        "goal_region_m": 0.25,
        "steering": "straight",
        "min_turning_radius_m": 0.0,
        "smoothing": Smoothing(),
        "anytime": None,
    }
    return TrunkPathQuery(grid=grid, start=pose(*start), goal=pose(*goal), **(fields | changes))


def pose(x_m: float, y_m: float, yaw_rad: float = 0.0) -> Pose2:
    return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)


def positions(plan: Plan) -> Floats:
    """Positions of a plan's waypoints, (n, 2)."""
    return np.array([(waypoint.x_m, waypoint.y_m) for waypoint in plan.waypoints])


def true_clearance(grid: OccupancyGrid, points: Floats) -> Floats:
    """Distance of points, (n, 2), to the nearest occupied square or the outside: every square looked at."""
    cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)
    low = np.array(grid.origin_m)
    high = low + np.array([grid.n_columns, grid.n_rows]) * grid.resolution_m
    clearance: Floats = np.maximum(np.minimum(points - low, high - points).min(axis=1), 0.0)
    rows, columns = np.nonzero(cells)
    if len(rows) == 0:
        return clearance
    corner = low + np.stack([columns, rows], axis=-1) * grid.resolution_m
    for k, point in enumerate(points):
        outside = np.maximum(np.maximum(corner - point, point - corner - grid.resolution_m), 0.0)
        clearance[k] = min(clearance[k], np.sqrt((outside**2).sum(axis=1).min()))
    return clearance


def samples(path: Floats, spacing_m: float) -> Floats:
    """Points all along a polyline, (n, 2), at most `spacing_m` apart, vertices among them."""
    parts = []
    for a, b in pairwise(path):
        n = max(1, int(np.ceil(np.linalg.norm(b - a) / spacing_m)))
        parts.append(a + (b - a) * (np.arange(n) / n)[:, None])
    return np.concatenate([*parts, path[-1:]])
