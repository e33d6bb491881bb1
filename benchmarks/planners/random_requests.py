"""Draws random requests, each from its number: map, clearance, start, goal, planner, steering and smoothing."""

from math import pi
from typing import Any, Final

import numpy as np

from legpush.arrays import Flags
from legpush.messages.planning import TrunkPathQuery
from legpush.scene.clearance import clearance
from legpush.scene.names import PlannerName, Steering
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.plan_settings import NOT_STEERED, Anytime, Smoothing
from planner_proc.conformance import cases

PLANNERS: Final[tuple[PlannerName, ...]] = (
    "rrt",
    "rrt_connect",
    "rrt_star",
    "informed_rrt_star",
    "bit_star",
    "prm_star",
)
STEERED_SHARE: Final = 0.3
FREE_PLACES_SHARE: Final = 0.93
"""Share of the requests whose start and goal are searched until the robot can stand there."""
MAX_SIDE: Final = 400
"""Most cells along a side."""


def random_request(number: int) -> TrunkPathQuery:
    """Return the request with this number."""
    rng = np.random.default_rng([20_261_126, number])
    grid = random_grid(rng)
    clearance_m = float(np.exp(rng.uniform(np.log(0.03), np.log(0.8))))
    start, goal = _places(rng, grid, clearance_m)
    planner = PLANNERS[number % len(PLANNERS)]
    steering: Steering = "straight"
    if rng.random() < STEERED_SHARE and len(NOT_STEERED.get(planner, ())) < 2:
        steering = "reeds_shepp" if rng.random() < 0.5 or "dubins" in NOT_STEERED.get(planner, ()) else "dubins"
    radius_m = 0.0 if steering == "straight" and rng.random() < 0.8 else float(rng.uniform(0.2, 1.0))
    method = ("band", "band", "spline", "none")[rng.integers(4)]
    smoothing = Smoothing(
        method="band" if method == "none" and radius_m > 0.0 else method,  # type: ignore[arg-type]
        shorten=bool(rng.random() < 0.8),
        comfort_m=float(rng.uniform(0.0, 0.6)),
        max_deviation_m=float(rng.uniform(0.1, 1.0)) if rng.random() < 0.25 else None,
    )
    changes: dict[str, Any] = {
        "clearance_m": clearance_m,
        "planner": planner,
        "seed": int(rng.integers(2**32)),
        "max_iterations": int(rng.integers(50, 800)),
        "step_m": float(rng.uniform(0.2, 2.0)),
        "goal_bias": float(rng.uniform(0.0, 0.3)),
        "goal_region_m": float(rng.uniform(0.05, 1.0)),
        "steering": steering,
        "min_turning_radius_m": radius_m,
        "smoothing": smoothing,
        "anytime": Anytime(n_improvements=1, improvement_iterations=100) if rng.random() < 0.2 else None,
    }
    return cases.query(grid, start, goal, **changes)


def random_grid(rng: np.random.Generator) -> OccupancyGrid:
    """Draw a map of walls with gaps, blocks, discs and single cells; sizes, cells and place are random, too."""
    resolution_m = float(rng.choice([0.02, 0.03, 0.05, 0.05, 0.1, 0.1, 0.2, 0.37]))
    longest = min(MAX_SIDE, int(30.0 / resolution_m))
    shape = tuple(int(rng.integers(max(12, longest // 6), longest + 1)) for _ in range(2))
    cells = np.zeros(shape, dtype=np.bool_)
    for _ in range(rng.integers(0, 5)):
        _wall(rng, cells)
    for _ in range(rng.integers(0, 16)):
        row, column = (int(rng.integers(0, n)) for n in shape)
        height, width = (int(rng.integers(1, max(2, n // 6))) for n in shape)
        cells[row : row + height, column : column + width] = True
    rows, columns = np.indices(shape)
    for _ in range(rng.integers(0, 4)):
        middle_row, middle_column = (rng.uniform(0, n) for n in shape)
        cells |= np.hypot(rows - middle_row, columns - middle_column) < rng.uniform(1.0, 0.1 * min(shape) + 1.0)
    if rng.random() < 0.15:
        cells |= rng.random(shape) < rng.choice([0.0005, 0.003])
    reach_m = float(rng.choice([0.0, 10.0, 1e3, 1e5]))
    return OccupancyGrid(
        n_columns=shape[1],
        n_rows=shape[0],
        resolution_m=resolution_m,
        origin_m=(float(rng.uniform(-1.0, 1.0)) * reach_m, float(rng.uniform(-1.0, 1.0)) * reach_m),
        cells=cells.astype(np.uint8).tobytes(),
    )


def _wall(rng: np.random.Generator, cells: Flags) -> None:
    """Draw a wall straight across the map, with a gap somewhere."""
    across = cells if rng.random() < 0.5 else cells.T
    n_rows, n_columns = across.shape
    row, gap = int(rng.integers(0, n_rows)), int(rng.integers(2, max(3, n_columns // 3)))
    first = int(rng.integers(0, n_columns - gap + 1))
    wall = slice(row, row + int(rng.integers(1, 4)))
    across[wall, :first] = True
    across[wall, first + gap :] = True


def _places(
    rng: np.random.Generator, grid: OccupancyGrid, clearance_m: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Draw start and goal with headings: mostly places where the robot can stand, sometimes any places."""
    size_m = np.array([grid.n_columns, grid.n_rows]) * grid.resolution_m
    drawn = rng.uniform(-0.02, 1.02, (30, 2)) * size_m + np.array(grid.origin_m)
    if rng.random() < FREE_PLACES_SHARE:
        free = [place for place in drawn if clearance(grid, place[None]).distance_m >= clearance_m]
        drawn = np.array([*free[:2], *drawn[: 2 - len(free[:2])]])
    (ax, ay), (bx, by) = drawn[:2].tolist()
    return (ax, ay, float(rng.uniform(-pi, pi))), (bx, by, float(rng.uniform(-pi, pi)))
