"""Planners of other projects as functions of our query; this is the only module that imports them.

Their collision tests look at cells or samples. So each planner gets the map in its own form, inflated by the clearance
and by what its test can miss.
"""

import os
import random
from collections.abc import Callable
from math import sqrt
from time import perf_counter
from typing import Any, Final

import numpy as np
from pathplanning import RrtParams, plan_continuous
from pathplanning.core.contracts import ContinuousProblem, GoalState
from pathplanning.spaces.grid2d import Grid2DSamplingSpace
from python_motion_planning.common import TYPES, Grid
from python_motion_planning.path_planner import RRT, RRTStar

from legpush.arrays import Floats
from legpush.messages.planning import TrunkPathQuery
from legpush.scenarios.grid import merged_cells

Peer = Callable[[TrunkPathQuery, int], Floats | None]
"""Returns a path, (n, 2), for a query and a seed, or None if none was found."""

LONGEST_S: Final = 20.0
"""Time limit of the peers that have one."""
MAX_SAMPLES: Final = 10_000
SPARE_M: Final = 0.02
SAMPLED_M: Final = 0.05

COMPILED: Final = os.environ.get("NUMBA_DISABLE_JIT", "0") != "1"
"""Whether python_motion_planning's collision test runs through Numba, its default; otherwise it is pure Python."""


def motion_planning(
    query: TrunkPathQuery, seed: int, *, star: bool, until: Callable[[TrunkPathQuery, int], float] | None = None
) -> Floats | None:
    """Plan with python_motion_planning until it has a path or, with `until`, a path of at most that length.

    An edge collides if a cell on its line is occupied or inflated. A point is up to half a cell's diagonal from the
    centre of its cell, and a square reaches as far beyond its own centre; so the map is inflated by a whole diagonal
    more.
    """
    grid, resolution_m = query.grid, query.grid.resolution_m
    low = np.array(grid.origin_m) - resolution_m
    # The library rounds the number of cells down.
    high = low + (np.array([grid.n_columns, grid.n_rows]) + 2.001) * resolution_m
    cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)
    # A ring of occupied cells marks the outside.
    occupied = np.pad(cells != 0, 1, constant_values=True).T
    world = Grid(
        bounds=np.stack([low, high], axis=1),
        resolution=resolution_m,
        type_map=np.where(occupied, TYPES.OBSTACLE, TYPES.FREE).astype(np.int8),
    )
    world.inflate_obstacles(query.clearance_m + sqrt(2.0) * resolution_m)

    def to_map(point_m: Floats) -> tuple[float, ...]:
        return tuple(((point_m - low) / resolution_m - 0.5).tolist())

    random.seed(seed)
    options: dict[str, Any] = {"max_dist": query.step_m / resolution_m, "goal_sample_rate": query.goal_bias}
    if star:
        until_s = perf_counter() + LONGEST_S
        most = 0.0 if until is None else until(query, seed) / resolution_m

        def stops(n: int, first: int | None, n_most: int) -> bool:
            del n_most
            is_short = first is not None and (until is None or planner.best_results[1]["length"] <= most)
            return is_short or perf_counter() > until_s

        options["stop_func"] = stops
    planner = (RRTStar if star else RRT)(
        map_=world,
        start=to_map(query.start.xy()),
        goal=to_map(query.goal.xy()),
        max_sample_step=MAX_SAMPLES,
        **options,
    )
    path, found = planner.plan()
    if not path or (until is not None and found["length"] > most):
        return None
    return (np.array(path) + 0.5) * resolution_m + low


def path_planning(query: TrunkPathQuery, seed: int, *, planner: str) -> Floats | None:
    """Plan with pathplanning, a search in C; the rectangles grow by the clearance and a spare, since edges are
    sampled."""
    grid, resolution_m = query.grid, query.grid.resolution_m
    cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)
    left, bottom = grid.origin_m
    kept_m = query.clearance_m + SPARE_M
    rectangles = [
        (
            left + first * resolution_m,
            bottom + row * resolution_m,
            (last - first) * resolution_m,
            (after - row) * resolution_m,
        )
        for row, after, first, last in merged_cells(cells != 0).tolist()
    ]
    space = Grid2DSamplingSpace(
        (left + kept_m, left + grid.n_columns * resolution_m - kept_m),
        (bottom + kept_m, bottom + grid.n_rows * resolution_m - kept_m),
        obs_rectangle=rectangles,
        delta=kept_m,
        collision_step=SAMPLED_M,
    )
    params = RrtParams(
        max_iters=MAX_SAMPLES,
        step_size=query.step_m,
        goal_sample_rate=query.goal_bias,
        collision_step=SAMPLED_M,
        time_budget_s=LONGEST_S,
    )
    start, goal = ((pose.x_m, pose.y_m) for pose in (query.start, query.goal))
    problem = ContinuousProblem(space=space, start=start, goal=GoalState(goal))
    result = plan_continuous(problem, planner=planner, params=params, seed=seed)
    return np.asarray(result.path, dtype=np.float64) if result.success and result.path is not None else None
