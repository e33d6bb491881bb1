"""The quickest sequence of pushes and walks that is predicted to bring the box to its goal.

A weighted A* search over the pose of the box and the face that the robot stands at. The lower bound of the time that is
left counts pushes by distance and turn, and a walk where the goal is not in the cone that pushes at the present face
reach: a box cannot be pulled.
"""

import heapq
from collections.abc import Callable, Mapping, Sequence
from math import cos, hypot, inf, log2, radians, sin
from typing import Final

from agent_proc.pushing.docking.moves import PUSH_S, DockMove, DockPush, DockWalk, walk_s
from legpush.geometry import Pose2
from legpush.scene.faces import TURN_RAD
from legpush.scene.names import Face

WEIGHT: Final = 1.5
"""Of the pushes in the lower bound: a sequence may take this many times the time of the quickest one."""
MAX_NODES: Final = 20_000
"""Poses that are looked at before the search gives up: about two seconds. Most searches need less than a thousand."""
CELL_M: Final = 0.004
CELL_RAD: Final = radians(0.5)
"""Poses in the same cell count as one. This is the least size of a cell."""
GROWTH: Final = 0.1
"""Cells double in size wherever this share of the distance to the goal allows it: far away, a rough pose will do."""
MOST_DOUBLED: Final = 3
"""How often at most: a push has to leave its cell."""
AREA_M: Final = 0.5
"""The box stays within this distance of its goal."""

IsFree = Callable[[Pose2, Face], bool]
"""Whether box and robot have space where the robot pushes the box at a face; the box is in the frame of the goal."""
_Node = tuple[float, float, float, Face | None]


class DockSearch:
    """Searches with the pushes of one box; all poses are those of its centre, in the frame of the goal."""

    def __init__(
        self,
        pushes: Mapping[Face, Sequence[DockPush]],
        near_m: float,
        near_rad: float,
        *,
        area_m: float = AREA_M,
        max_nodes: int = MAX_NODES,
    ) -> None:
        """The box is at its goal within `near_m` and `near_rad`, and stays within `area_m` of it."""
        every = [push for at_face in pushes.values() for push in at_face]
        ahead = [(push, *_ahead(push)) for push in every]
        self._pushes = pushes
        self._near_m, self._near_rad = near_m, near_rad
        self._area_m, self._max_nodes = area_m, max_nodes
        self._most_m = max(hypot(push.x_m, push.y_m) for push in every)
        self._most_rad = max(abs(push.yaw_rad) for push in every)
        self._sideways = max(abs(left_m) / forward_m for _, forward_m, left_m in ahead)
        """Shift to the side per way ahead."""
        self._curvature_per_m = max(abs(push.yaw_rad) / forward_m for push, forward_m, _ in ahead)

    def find(self, box: Pose2, face: Face | None, is_free: IsFree) -> tuple[DockMove, ...] | None:
        """Return the moves from a pose to the goal, or None if none were found; none at all if it is there.

        `face` is where the robot stands, if it stands at one.
        """
        start: _Node = (box.x_m, box.y_m, box.yaw_rad, face)
        best = {_cell(start): 0.0}
        came: dict[_Node, tuple[_Node, DockMove]] = {}
        queue = [(self._least_s(start), 0, 0.0, start)]
        n_queued = 0
        for _ in range(self._max_nodes):
            if not queue:
                return None
            _, _, spent_s, node = heapq.heappop(queue)
            if spent_s > best[_cell(node)]:
                continue
            pose = Pose2(x_m=node[0], y_m=node[1], yaw_rad=node[2])
            if node != start and node[3] is not None and not is_free(pose, node[3]):
                continue
            if self._is_there(node):
                return _moves(came, node)
            walked = node in came and isinstance(came[node][1], DockWalk)
            for move, after, takes_s in self._next(node, pose, walked=walked):
                cell, total_s = _cell(after), spent_s + takes_s
                if total_s < best.get(cell, inf) and hypot(after[0], after[1]) < self._area_m:
                    best[cell] = total_s
                    came[after] = (node, move)
                    n_queued += 1
                    heapq.heappush(queue, (total_s + self._least_s(after), n_queued, total_s, after))
        return None

    def _next(self, node: _Node, pose: Pose2, *, walked: bool) -> list[tuple[DockMove, _Node, float]]:
        """Return the moves from a node, where they lead, and how long they take."""
        found: list[tuple[DockMove, _Node, float]] = []
        face = node[3]
        if face is not None:
            for push in self._pushes[face]:
                after = push.after(pose)
                found.append((push, (after.x_m, after.y_m, after.yaw_rad, face), PUSH_S))
        if not walked:
            found += [(DockWalk(face=to), (*node[:3], to), walk_s(face, to)) for to in self._pushes if to != face]
        return found

    def _is_there(self, node: _Node) -> bool:
        x_m, y_m, yaw_rad, _ = node
        return hypot(x_m, y_m) <= self._near_m and abs(yaw_rad) <= self._near_rad

    def _least_s(self, node: _Node) -> float:
        """Return about the least time to the goal."""
        x_m, y_m, yaw_rad, face = node
        too_far_m, too_far_rad = hypot(x_m, y_m) - self._near_m, abs(yaw_rad) - self._near_rad
        pushes = max(too_far_m / self._most_m, too_far_rad / self._most_rad, 0.0)
        if pushes == 0.0:
            return 0.0
        least_s = WEIGHT * PUSH_S * pushes
        if face is not None and self._is_ahead(x_m, y_m, yaw_rad, face):
            return least_s
        return least_s + min((walk_s(face, to) for to in self._pushes if to != face), default=inf)

    def _is_ahead(self, x_m: float, y_m: float, yaw_rad: float, face: Face) -> bool:
        """Whether pushes at a face may bring the box to the goal."""
        c, s = cos(yaw_rad + TURN_RAD[face]), sin(yaw_rad + TURN_RAD[face])
        forward_m, left_m = -c * x_m - s * y_m + self._near_m, s * x_m - c * y_m
        aside_m = self._sideways * forward_m + self._curvature_per_m * forward_m**2 / 2
        return (
            forward_m >= 0.0
            and abs(left_m) <= self._near_m + aside_m
            and abs(yaw_rad) <= self._near_rad + 1.5 * self._curvature_per_m * forward_m
        )


def _ahead(push: DockPush) -> tuple[float, float]:
    """Return how far a push moves the box ahead and to the left, seen from the robot."""
    c, s = cos(TURN_RAD[push.face]), sin(TURN_RAD[push.face])
    return c * push.x_m + s * push.y_m, c * push.y_m - s * push.x_m


def _cell(node: _Node) -> tuple[int, int, int, int, int, Face | None]:
    x_m, y_m, yaw_rad, face = node
    cells_m = hypot(x_m, y_m) / CELL_M
    cells_rad = max(abs(yaw_rad) / CELL_RAD, cells_m / 2)
    doubled_m = min(int(log2(1.0 + GROWTH * cells_m)), MOST_DOUBLED)
    doubled_rad = min(int(log2(1.0 + GROWTH * cells_rad)), MOST_DOUBLED)
    size_m, size_rad = CELL_M * 2**doubled_m, CELL_RAD * 2**doubled_rad
    return doubled_m, doubled_rad, round(x_m / size_m), round(y_m / size_m), round(yaw_rad / size_rad), face


def _moves(came: Mapping[_Node, tuple[_Node, DockMove]], node: _Node) -> tuple[DockMove, ...]:
    moves: list[DockMove] = []
    while node in came:
        node, move = came[node]
        moves.append(move)
    return tuple(reversed(moves))
