"""A tree of pushes, grown from the start or from the goal."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from legpush.geometry import Pose2
from planner_proc.box.pushes import Pushes, Stage, Way

TURN_M_PER_RAD: Final = 0.5
"""What a difference in heading counts, for which node of the tree is nearest."""
N_NEAREST: Final = 4
"""Nodes that are near enough to grow from; the cheapest push decides."""


@dataclass(frozen=True, kw_only=True)
class Node:
    pose: Pose2
    parent: int | None
    """None of a root."""
    stage: Stage | None
    """Between it and its parent, of a root that leads to the goal to there; None of the start."""
    side: int | None
    """From the start: the one that the robot stands at. To the goal: the one from which pushing goes on."""


class Tree:
    """Poses that the start leads to or, `backward`, that lead to the goal, and the pushes between them."""

    def __init__(self, pushes: Pushes, size: int, *, backward: bool) -> None:
        self.nodes: list[Node] = []
        self._pushes = pushes
        self._poses = np.empty((size, 3))
        self._backward = backward

    def add(self, node: Node) -> Node:
        """One more."""
        self._poses[len(self.nodes)] = node.pose.x_m, node.pose.y_m, node.pose.yaw_rad
        self.nodes.append(node)
        return node

    def nearest(self, target: Pose2, n: int) -> list[int]:
        """So many nodes that are nearest to a pose, nearest first."""
        poses = self._poses[: len(self.nodes)]
        turn = np.abs((poses[:, 2] - target.yaw_rad + np.pi) % (2 * np.pi) - np.pi)
        distance = np.hypot(*(poses[:, :2] - target.xy()).T) + TURN_M_PER_RAD * turn
        found: list[int] = np.argsort(distance, kind="stable")[:n].tolist()
        return found

    def grow(self, target: Pose2, step_m: float) -> Node | None:
        """The cheapest push between a near node and the target, no longer than a step, added if it is free."""
        candidates = [self._candidate(index, target) for index in self.nearest(target, N_NEAREST)]
        _, index, stage = min(candidates, key=lambda candidate: candidate[0])
        stage, node = self._cut(stage, step_m), self.nodes[index]
        if not self._pushes.free(self._with_next(stage, index), stage.side if self._backward else node.side):
            return None
        pose = stage.begin if self._backward else stage.end
        return self.add(Node(pose=pose, parent=index, stage=stage, side=stage.side))

    def way(self, index: int) -> Way:
        """From the start to a node or, backward, from it to the goal."""
        stages: list[Stage] = []
        at: int | None = index
        while at is not None:
            node = self.nodes[at]
            stages += [] if node.stage is None else [node.stage]
            at = node.parent
        return tuple(stages if self._backward else reversed(stages))

    def _candidate(self, index: int, target: Pose2) -> tuple[float, int, Stage]:
        """The cheapest push between a node and the target."""
        node, pushes = self.nodes[index], self._pushes
        ends = (target, node.pose) if self._backward else (node.pose, target)
        (best,) = min(pushes.one_side(*ends), key=lambda way: pushes.cost_m(way, node.side))
        return pushes.cost_m((best,), node.side), index, best

    def _cut(self, stage: Stage, step_m: float) -> Stage:
        """The part of it that is next to the node."""
        if stage.length_m <= step_m:
            return stage
        if self._backward:
            middle = self._pushes.sides[stage.side].along(stage.begin, stage.end, stage.length_m - step_m)
            return Stage(side=stage.side, begin=middle, end=stage.end, length_m=step_m)
        middle = self._pushes.sides[stage.side].along(stage.begin, stage.end, step_m)
        return Stage(side=stage.side, begin=stage.begin, end=middle, length_m=step_m)

    def _with_next(self, stage: Stage, index: int) -> Way:
        """Backward also the push after it, since the robot may have to change sides in between."""
        after = self.nodes[index].stage
        return (stage,) if after is None or not self._backward else (stage, after)
