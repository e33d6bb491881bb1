"""The queries that all planners get: on golden maps with known answers, the published map, and random rooms."""

from functools import cache
from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.plans.trunk_queries import query_to_nominal_box
from legpush.scenarios.file import load_scenario
from legpush.scene.clearance import clearance
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.conformance import cases
from planner_proc.planning import make_plan

GOLDEN: Final = ("open floor", "around a wall", "maze", "narrow gate")
PUBLISHED: Final = ("published", "published_detour")
RANDOM: Final = tuple(f"random {number}" for number in range(1, 5))
MAPS: Final = (*GOLDEN, *PUBLISHED, *RANDOM)
LARGE: Final = "200 x 200 m"
HUGE: Final = "4000 x 4000 cells"

_ROOM_M: Final = (12.0, 9.0)
_N_BLOCKS: Final = 18
_FAR_M: Final = 7.0
_AROUND: Final = 1.15
"""Least length of the path, as a multiple of the straight line."""
_N_BLOCKS_LARGE: Final = 200


@cache
def question(name: str) -> TrunkPathQuery:
    """Return the query on the map with this name; the caller replaces seed, planner and budget."""
    if name in PUBLISHED:
        scenario = load_scenario(name)
        return query_to_nominal_box(scenario, 0, scenario.start.pose(), "rear")
    if name.startswith("random"):
        return _random(int(name.split()[1]))
    if name == LARGE:
        return _large()
    if name == HUGE:
        return cases.huge()
    return next(case.query for case in cases.cases() if case.name == name)


def _random(number: int) -> TrunkPathQuery:
    """Draw a room of 12 x 9 m with random blocks and with start and goal far apart, until there is a winding way."""
    rng = np.random.default_rng(number)
    width_m, height_m = _ROOM_M
    while True:
        corners = rng.uniform((0.0, 0.0), _ROOM_M, (_N_BLOCKS, 2))
        sizes = rng.uniform(0.2, 1.4, (_N_BLOCKS, 2))
        blocks = [
            (x, min(x + w, width_m), y, min(y + h, height_m)) for (x, y), (w, h) in zip(corners, sizes, strict=True)
        ]
        grid = cases.room(width_m, height_m, *blocks)
        places = rng.uniform((0.0, 0.0), _ROOM_M, (40, 2))
        free = [place for place in places if clearance(grid, place[None]).distance_m > cases.CLEARANCE_M]
        for goal in free[1:]:
            query = cases.query(grid, tuple(free[0].tolist()), tuple(goal.tolist()))
            apart_m = float(np.hypot(*(goal - free[0])))
            if apart_m > _FAR_M and _is_winding(make_plan(query), apart_m):
                return query


def _is_winding(plan: Plan, apart_m: float) -> bool:
    """Whether there is a way, and it is much longer than the straight line."""
    return plan.status == "exact" and plan.length_m > _AROUND * apart_m


def _large() -> TrunkPathQuery:
    """Return a query from corner to corner of a map of 200 x 200 m in cells of 0.1 m with 200 blocks."""
    rng = np.random.default_rng(0)
    cells = np.zeros((2000, 2000), dtype=np.uint8)
    for _ in range(_N_BLOCKS_LARGE):
        (column, row), (width, height) = rng.integers(0, 2000, 2).tolist(), rng.integers(10, 80, 2).tolist()
        cells[row : row + height, column : column + width] = 1
    cells[:40, :40] = cells[-40:, -40:] = 0
    grid = OccupancyGrid(n_columns=2000, n_rows=2000, resolution_m=0.1, origin_m=(0.0, 0.0), cells=cells.tobytes())
    return replace(cases.query(grid, (2.0, 2.0), (198.0, 198.0)), step_m=1.5, max_iterations=50_000)
