"""Whether the body of the robot, and not only a disc, can walk around the box from one side to another."""

from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import OccupancyGrid, with_footprint
from planner_proc.body import lattice
from planner_proc.body.space import BodySpace
from planner_proc.clearance.field import ClearanceField

WITHIN_M: Final = (1.5, 4.0)
"""How far from the line between the two sides, around the box, to look for a walk, in turn."""


class BodyWalks:
    """Walks of the body in a room with the box."""

    def __init__(self, grid: OccupancyGrid, box: Footprint, body: Footprint, disc_m: float, body_m: float) -> None:
        """Take the clearance of the trunk's centre, and the body, in the frame of the trunk, with its clearance."""
        self._box_m = box.pose.xy()
        occupied = with_footprint(grid, box)
        self._step_m = max(lattice.LEAST_STEP_M, grid.resolution_m)
        self._space = BodySpace(occupied, ClearanceField(occupied), disc_m, body, body_m)

    def joins(self, begins: Floats, end: Floats) -> bool:
        """Whether a walk leads from one of the poses `begins`, (n, 3), to the pose `end`, (3,)."""
        free = np.flatnonzero(self._space.body_is_free(begins))
        if not len(free):
            return False
        begin = begins[free[0]]
        along_m = np.stack([begin[:2], self._box_m, end[:2]])
        return any(
            len(lattice.search(self._space, begin, end, along_m, within_m, self._step_m)) for within_m in WITHIN_M
        )
