"""A random tree whose edges are pushes of the box, rooted at the start or at the goal."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from legpush.geometry import Pose2
from planner_proc.box.pushes import Pushes, Stage, Way

TURN_M_PER_RAD: Final = 0.5
"""Weight of the heading in the distance between two poses."""
N_NEAREST: Final = 4
"""How many nearest nodes to try growing from; the cheapest push wins."""


@dataclass(frozen=True, kw_only=True)
class Node:
    """A pose of the box, and the push that connects it to the tree."""

    pose: Pose2
    parent: int | None
    """Index of its parent; None for a root."""
    stage: Stage | None
    """The push between the node and its parent; for a root of the tree to the goal, the push into the goal; None for
    the start.
    """
    side: int | None
    """In the tree from the start, the side where the robot stands; in the tree to the goal, the side that it pushes
    next. None if the robot stands at no side.
    """


class Tree:
    """Poses that can be reached from the start or, if `backward`, from which the goal can be reached."""

    def __init__(self, pushes: Pushes, size: int, *, backward: bool) -> None:
        """Make an empty tree that has room for `size` nodes."""
        self.nodes: list[Node] = []
        self._pushes = pushes
        self._poses = np.empty((size, 3))
        self._backward = backward

    def add(self, node: Node) -> Node:
        """Add a node, and return it."""
        self._poses[len(self.nodes)] = node.pose.x_m, node.pose.y_m, node.pose.yaw_rad
        self.nodes.append(node)
        return node

    def nearest(self, target: Pose2, n: int) -> list[int]:
        """Indices of the `n` nodes nearest to a pose, nearest first."""
        poses = self._poses[: len(self.nodes)]
        turn = np.abs((poses[:, 2] - target.yaw_rad + np.pi) % (2 * np.pi) - np.pi)
        distance = np.hypot(*(poses[:, :2] - target.xy()).T) + TURN_M_PER_RAD * turn
        found: list[int] = np.argsort(distance, kind="stable")[:n].tolist()
        return found

    def grow(self, target: Pose2, step_m: float) -> Node | None:
        """Push from a near node toward the target by at most a step, and add where that ends.

        Backward, the push ends at the node and begins toward the target. Returns None if the push is not free.
        """
        candidates = [self._candidate(index, target) for index in self.nearest(target, N_NEAREST)]
        _, index, stage = min(candidates, key=lambda candidate: candidate[0])
        stage, node = self._cut(stage, step_m), self.nodes[index]
        if not self._pushes.free(self._with_next(stage, index), stage.side if self._backward else node.side):
            return None
        pose = stage.begin if self._backward else stage.end
        return self.add(Node(pose=pose, parent=index, stage=stage, side=stage.side))

    def way(self, index: int) -> Way:
        """The stages from the start to a node or, backward, from the node to the goal."""
        stages: list[Stage] = []
        at: int | None = index
        while at is not None:
            node = self.nodes[at]
            stages += [] if node.stage is None else [node.stage]
            at = node.parent
        return tuple(stages if self._backward else reversed(stages))

    def _candidate(self, index: int, target: Pose2) -> tuple[float, int, Stage]:
        """Cost of the cheapest push between a node and the target, the node's index, and the push."""
        node, pushes = self.nodes[index], self._pushes
        ends = (target, node.pose) if self._backward else (node.pose, target)
        (best,) = min(pushes.one_side(*ends), key=lambda way: pushes.cost_m(way, node.side))
        return pushes.cost_m((best,), node.side), index, best

    def _cut(self, stage: Stage, step_m: float) -> Stage:
        """The part of a push that is next to the node, no longer than a step."""
        if stage.length_m <= step_m:
            return stage
        if self._backward:
            middle = self._pushes.sides[stage.side].along(stage.begin, stage.end, stage.length_m - step_m)
            return Stage(side=stage.side, begin=middle, end=stage.end, length_m=step_m)
        middle = self._pushes.sides[stage.side].along(stage.begin, stage.end, step_m)
        return Stage(side=stage.side, begin=stage.begin, end=middle, length_m=step_m)

    def _with_next(self, stage: Stage, index: int) -> Way:
        """A push and, backward, the one after it: the robot may have to change sides in between."""
        after = self.nodes[index].stage
        return (stage,) if after is None or not self._backward else (stage, after)
