"""Queries with known answers: maps, starts and goals that every planner should be able to handle."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from legpush.arrays import Flags
from legpush.geometry import Pose2
from legpush.messages.planning import BoxPathQuery, PlanStatus, PushSide, TrunkPathQuery
from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.plan_settings import Smoothing

CLEARANCE_M: Final = 0.44
RESOLUTION_M: Final = 0.05
AHEAD: Final = Pose2(x_m=4.0, y_m=3.0, yaw_rad=0.0)
"""Goal of the box, straight ahead of its start."""
HERE: Final = Pose2(x_m=3.0, y_m=3.0, yaw_rad=0.0)
"""Start of the box, and its goal where nothing is left to push."""
ASIDE: Final = Pose2(x_m=5.2, y_m=3.4, yaw_rad=0.3)
"""Goal of the box, to the side and turned."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A query, and the statuses that are honest answers to it."""

    name: str
    query: TrunkPathQuery
    expected: tuple[PlanStatus, ...]


def cases() -> tuple[Case, ...]:
    """All cases of trunk paths, easy ones first."""
    open_floor = room(8.0, 6.0)
    no_path: tuple[PlanStatus, ...] = ("approximate", "failed", "invalid")
    wall = room(8.0, 6.0, (3.9, 4.1, 0.0, 4.4))
    maze = room(12.0, 8.0, (2.4, 2.6, 0.0, 6.4), (4.9, 5.1, 1.6, 8.0), (7.4, 7.6, 0.0, 6.4), (9.9, 10.1, 1.6, 8.0))
    gate = room(8.0, 6.0, (3.9, 4.1, 0.0, 2.5), (3.9, 4.1, 3.5, 6.0))
    cut = room(8.0, 6.0, (3.9, 4.1, 0.0, 6.0))
    block = room(8.0, 6.0, (1.0, 2.0, 1.0, 2.0))
    return (
        Case(name="open floor", query=query(open_floor, (1.0, 1.0, 0.5), (7.0, 5.0, -1.0)), expected=("exact",)),
        Case(name="already at the goal", query=query(open_floor, (2.0, 2.0), (2.0, 2.0, 2.0)), expected=("exact",)),
        Case(name="around a wall", query=query(wall, (1.0, 1.0), (7.0, 1.0)), expected=("exact",)),
        Case(name="maze", query=query(maze, (1.2, 1.0), (11.2, 1.0)), expected=("exact",)),
        Case(name="narrow gate", query=query(gate, (1.0, 3.0), (7.0, 3.0)), expected=("exact",)),
        Case(name="unreachable goal", query=query(cut, (1.0, 3.0), (7.0, 3.0), max_iterations=500), expected=no_path),
        Case(name="start in an obstacle", query=query(block, (1.5, 1.5), (7.0, 5.0)), expected=("invalid",)),
        Case(name="goal too near to a wall", query=query(block, (4.0, 4.0), (2.3, 1.5)), expected=("invalid",)),
        Case(name="goal off the map", query=query(open_floor, (1.0, 1.0), (9.0, 1.0)), expected=("invalid",)),
        Case(name="huge map, 4000 x 4000 cells", query=huge(), expected=("exact",)),
    )


def query(grid: OccupancyGrid, start: tuple[float, ...], goal: tuple[float, ...], **changes: Any) -> TrunkPathQuery:
    """A query for a path of the trunk, as a mission asks it, between poses (x, y) or (x, y, yaw)."""
    fields: dict[str, Any] = {
        "clearance_m": CLEARANCE_M,
        "planner": "rrt_connect",
        "seed": 7,
        "max_iterations": 20_000,
        "goal_bias": 0.05,
        "step_m": 0.5,
        "goal_region_m": 0.25,
        "steering": "straight",
        "min_turning_radius_m": 0.0,
        "smoothing": Smoothing(),
        "anytime": None,
    }
    return TrunkPathQuery(grid=grid, start=_pose(*start), goal=_pose(*goal), **(fields | changes))


def box_query(goal: Pose2) -> BoxPathQuery:
    """A query for a path of the box from `HERE` on an open floor; it can be pushed at one side."""
    here = _pose(0.0, 0.0)
    side = PushSide(
        frame=here,
        min_turning_radius_m=0.7,
        footprints=(
            Footprint(pose=here, length_m=0.4, width_m=0.5),
            Footprint(pose=_pose(-0.62, 0.0), length_m=0.76, width_m=0.44),
        ),
        stand_off=_pose(-0.95, 0.0),
    )
    return BoxPathQuery(
        grid=room(8.0, 6.0),
        start=HERE,
        goal=goal,
        sides=(side,),
        present_side=None,
        box=Footprint(pose=here, length_m=0.4, width_m=0.5),
        walk_clearance_m=CLEARANCE_M,
        side_change_m=0.5,
        clearance_m=0.05,
        run_in_m=0.4,
        position_tolerance_m=0.01,
        angle_tolerance_rad=0.02,
        seed=7,
        max_iterations=3000,
        goal_bias=0.1,
        step_m=1.0,
    )


def room(width_m: float, height_m: float, *blocks: tuple[float, float, float, float]) -> OccupancyGrid:
    """A grid of a floor with occupied blocks (x_min, x_max, y_min, y_max), in metres."""
    cells = np.zeros((round(height_m / RESOLUTION_M), round(width_m / RESOLUTION_M)), dtype=np.bool_)
    for block in blocks:
        left, right, bottom, top = (round(side / RESOLUTION_M) for side in block)
        cells[bottom:top, left:right] = True
    return _grid(cells)


def huge() -> TrunkPathQuery:
    """A query on a map of 4000 x 4000 cells, 200 x 200 m, with pillars everywhere."""
    cells = np.zeros((4000, 4000), dtype=np.bool_)
    for low in range(150, 4000, 300):
        cells[low : low + 40, 150::300] = True
    return query(_grid(cells), (2.0, 2.0), (12.0, 14.0))


def _grid(cells: Flags) -> OccupancyGrid:
    n_rows, n_columns = cells.shape
    return OccupancyGrid(
        n_columns=n_columns,
        n_rows=n_rows,
        resolution_m=RESOLUTION_M,
        origin_m=(0.0, 0.0),
        cells=cells.astype(np.uint8).tobytes(),
    )


def _pose(x_m: float, y_m: float, yaw_rad: float = 0.0) -> Pose2:
    return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)


BESIDE_A_WALL: Final = query(
    room(8.0, 6.0),
    (4.0, 0.5, 0.0),
    (2.0, 2.0, 3.0),
    body=Footprint(pose=Pose2(x_m=-0.11, y_m=0.0, yaw_rad=0.0), length_m=0.98, width_m=0.44),
    body_clearance_m=0.05,
)
"""A robot beside a wall that has to leave it before it turns round."""
