"""Obstacles that appear later: when each of them is due, and whether its place is clear."""

from copy import copy
from math import ceil
from typing import Final

from legpush.geometry import Pose2
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.footprints import Footprint, box_footprint, distance_m, distance_to_point_m, obstacle_footprint
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Room

CELL_M: Final = 0.1
"""Room for the diagonal of a cell of the map."""
BOX_CLEARANCE_M: Final = 0.2
"""Least distance from the box to an obstacle that appears: the travel of a push and a cell's diagonal."""
ROUNDING_TICKS: Final = 1e-6
"""A time this close above a whole number of ticks counts as that number."""
NEVER: Final = 2**62
"""A tick that no episode reaches."""


class Waiting:
    """The obstacles of a room that have not appeared yet."""

    def __init__(self, room: Room, box: Box, robot: RobotSpec) -> None:
        """Begin with every obstacle that appears later."""
        self._robot_clearance_m = robot_clearance_m(robot)
        self._box = box
        self._due = {
            index: (ceil(obstacle.appears_at_s / CONTROL_PERIOD_S - ROUNDING_TICKS), obstacle_footprint(obstacle))
            for index, obstacle in enumerate(room.obstacles)
            if obstacle.appears_at_s > 0.0
        }
        self.indices = tuple(self._due)
        """All obstacles of the room that appear later, also those that have appeared."""
        self.next_tick = self._next_tick()
        """When the first waiting obstacle is due; `NEVER` if none is left."""

    def copy(self) -> "Waiting":
        """Return the same obstacles, waiting apart from these."""
        other = copy(self)
        other._due = dict(self._due)
        return other

    def take_due(self, tick: int, trunk: Pose2, box: Pose2) -> list[int]:
        """Remove and return the obstacles that appear at the end of a tick.

        They are due, and robot and box are far enough away.
        """
        footprint = box_footprint(self._box, box)
        due = [(index, place) for index, (due_tick, place) in self._due.items() if due_tick <= tick]
        taken = [index for index, place in due if self._is_clear(place, trunk, footprint)]
        for index in taken:
            del self._due[index]
        self.next_tick = self._next_tick()
        return taken

    def _next_tick(self) -> int:
        return min((tick for tick, _ in self._due.values()), default=NEVER)

    def _is_clear(self, place: Footprint, trunk: Pose2, box: Footprint) -> bool:
        """Whether robot and box are far enough from a place."""
        robot_m = distance_to_point_m(place, trunk.xy())
        return robot_m >= self._robot_clearance_m and distance_m(place, box) >= BOX_CLEARANCE_M


def robot_clearance_m(robot: RobotSpec) -> float:
    """Least distance from the trunk to an obstacle that appears.

    The robot sees it after the gait cycle, at most a stride farther on. To plan from there it still needs a cell's
    diagonal more room than its feet take.
    """
    return robot.stance.foot_circle_m + (robot.gait.stride_m + CELL_M)
