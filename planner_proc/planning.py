"""Plans: checks the query, then plans a path of the trunk or of the box. No I/O; equal queries get equal plans."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from legpush.bounds import MAX_CELLS
from legpush.messages.planning import BoxPathQuery, Plan, PlanQuery, TrunkPathQuery
from legpush.plans.planner import Interrupted
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.box_plan import make_box_plan
from planner_proc.clearance.field import NEAR_M, ClearanceField
from planner_proc.search.registry import search_fault
from planner_proc.trunk_plan import make_trunk_plans

_MAX_COORDINATE_M: Final = 1e7
"""Farther from the world's origin than this, a float64 no longer resolves `ROUNDING_M`."""
_LEAST_STEP_M: Final = 1e-6


def make_plan(query: PlanQuery) -> Plan:
    """Return the first plan for a query."""
    return next(make_plans(query, lambda: False))


def make_plans(query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
    """Yield a plan for a query and then, with `anytime`, the best plan after each improvement.

    A query that cannot be met is no error: the plan's `status` and `reason` say so.

    Raises:
        PlanningInterruptedError: The plans are not wanted any more.
    """
    fault = _grid_fault(query.grid) or _search_fault(query)
    if fault:
        yield Plan(status="invalid", reason=fault)
        return
    field = ClearanceField(query.grid, _near_m(query))
    if isinstance(query, BoxPathQuery):
        yield make_box_plan(query, field, interrupted)
    else:
        yield from make_trunk_plans(query, field, interrupted)


def _grid_fault(grid: OccupancyGrid) -> str:
    """Why the grid is invalid; empty if it is not."""
    n_cells = grid.n_rows * grid.n_columns
    if n_cells > MAX_CELLS:
        return f"Expected at most {MAX_CELLS} cells, got n_rows * n_columns = {n_cells}"
    if len(grid.cells) != n_cells:
        return (
            f"Expected n_rows * n_columns = {grid.n_rows} * {grid.n_columns} = {n_cells} cells, got {len(grid.cells)}"
        )
    cells = np.frombuffer(grid.cells, dtype=np.uint8)
    if cells.max() > 1:
        worst = int(cells.argmax())
        row, column = divmod(worst, grid.n_columns)
        return f"Expected cells of 0 (free) or 1 (occupied), got {cells[worst]} in row {row}, column {column}"
    (x_m, y_m), (right_m, top_m) = grid.origin_m, grid.far_corner_m()
    if not max(abs(x_m), abs(y_m), abs(right_m), abs(top_m)) <= _MAX_COORDINATE_M:
        return f"Expected a map within {_MAX_COORDINATE_M:g} m of (0, 0), got {grid.extent()}"
    return ""


def _search_fault(query: PlanQuery) -> str:
    """Why the search cannot be carried out as the query asks; empty if it can."""
    if not query.step_m >= _LEAST_STEP_M:
        return f"Expected step_m of at least {_LEAST_STEP_M:g} m, got {query.step_m:g}"
    return search_fault(query) if isinstance(query, TrunkPathQuery) else ""


def _near_m(query: PlanQuery) -> float:
    """How far from the occupied cells the planner needs to know which of them is nearest."""
    if isinstance(query, BoxPathQuery):
        return max(NEAR_M, query.walk_clearance_m, query.clearance_m) + query.grid.resolution_m
    # A clearance that is not a number is refused later.
    return max(query.grid.resolution_m, query.clearance_m + query.smoothing.comfort_m + 2.0 * query.grid.resolution_m)
