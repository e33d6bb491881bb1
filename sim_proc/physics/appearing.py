"""Obstacles that appear later: when each is due, and whether anything is in its place."""

from math import ceil
from typing import Final

from legpush.geometry import Pose2
from legpush.scene.footprints import Footprint, box_footprint, distance_m, distance_to_point_m, obstacle_footprint
from legpush.scene.robot import CONTROL_PERIOD_S, FOOT_RECTANGLE_RADIUS_M
from legpush.scene.scenario import Box, Room

ROBOT_CLEARANCE_M: Final = FOOT_RECTANGLE_RADIUS_M + 0.5
"""From the trunk to what appears: the robot sees it after the gait cycle, 0.4 m farther on at most, and still has to
have a cell's diagonal more than its feet need, to plan from there."""
BOX_CLEARANCE_M: Final = 0.2
"""From the box to what appears: as far as a push takes it, and a cell's diagonal."""
ROUNDING_TICKS: Final = 1e-6
"""A time that is a whole number of ticks but for rounding is that number."""
NEVER: Final = 2**62


class Waiting:
    """The obstacles of a room that are yet to appear."""

    def __init__(self, room: Room, box: Box) -> None:
        self._box = box
        self._due = {
            index: (ceil(obstacle.appears_at_s / CONTROL_PERIOD_S - ROUNDING_TICKS), obstacle_footprint(obstacle))
            for index, obstacle in enumerate(room.obstacles)
            if obstacle.appears_at_s > 0.0
        }
        self.indices = tuple(self._due)
        """All of them, as they were at first."""
        self.next_tick = self._next_tick()
        """When the first of those that are left is due; `NEVER` without any."""

    def take(self, tick: int, trunk: Pose2, box: Pose2) -> list[int]:
        """Those that appear at the end of this tick: they are due, and robot and box are far enough away."""
        footprint = box_footprint(self._box, box)
        due = [(index, place) for index, (due_tick, place) in self._due.items() if due_tick <= tick]
        taken = [index for index, place in due if _is_clear(place, trunk, footprint)]
        for index in taken:
            del self._due[index]
        self.next_tick = self._next_tick()
        return taken

    def _next_tick(self) -> int:
        return min((tick for tick, _ in self._due.values()), default=NEVER)


def _is_clear(place: Footprint, trunk: Pose2, box: Footprint) -> bool:
    """Whether neither robot nor box is near a place."""
    return distance_to_point_m(place, trunk.xy()) >= ROBOT_CLEARANCE_M and distance_m(place, box) >= BOX_CLEARANCE_M
