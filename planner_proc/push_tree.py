"""A tree of pushes (RRT) from where the box is, grown until its goal can be reached, and what it found made shorter."""

from dataclasses import dataclass, field
from math import inf
from typing import Final

import numpy as np
from numpy.typing import NDArray

from legpush.geometry import Pose2
from legpush.messages import BoxPathQuery, Point2
from planner_proc.pushes import Pushes, Stage, Way

Floats = NDArray[np.float64]

TURN_M_PER_RAD: Final = 0.5
"""What a difference in heading counts, for which node of the tree is nearest."""
N_NEAREST: Final = 4
"""Nodes that are near enough to grow from; the cheapest push decides."""
N_DIRECT: Final = 12
"""Ways from start to goal that are tried before a tree is grown, cheapest first."""
N_TO_GOAL: Final = 3
"""The same from each node of the tree."""
MORE: Final = 2
LEAST_MORE: Final = 40
"""Once the goal is reached, the tree grows on for as many iterations again, and some: a cheaper way may show up."""
N_SHORTENED: Final = 3
"""Of what was found, so many of the cheapest are made shorter."""
N_SHORTCUTS: Final = 80
"""Attempts to shorten what was found."""
LEAST_GAIN_M: Final = 0.01


@dataclass(frozen=True, kw_only=True)
class Found:
    """What the search found, if anything."""

    way: Way
    """Empty where nothing was found."""
    tree_points_m: tuple[Point2, ...]
    tree_parents: tuple[int, ...]
    n_iterations: int


def search(query: BoxPathQuery, pushes: Pushes) -> Found:
    """The cheapest direct way that fits; else what the tree comes to. Equal queries get equal answers."""
    direct = pushes.best(pushes.to_goal(query.start, query.goal), query.present_side, inf, N_DIRECT)
    if direct is not None:
        return Found(way=direct, tree_points_m=_points(query.start, query.goal), tree_parents=(0, 0), n_iterations=0)
    tree = _Tree(query, pushes)
    ways: list[Way] = []
    n_iterations, n_wanted = 0, query.max_iterations
    while n_iterations < n_wanted:
        n_iterations += 1
        way = tree.grow()
        if way:
            ways.append(way)
            n_wanted = min(n_wanted, MORE * n_iterations + LEAST_MORE)
    ways.sort(key=lambda way: pushes.cost_m(way, query.present_side))
    shorter = [_shortened(way, query, pushes) for way in ways[:N_SHORTENED]]
    way = min(shorter, key=lambda way: pushes.cost_m(way, query.present_side), default=())
    return Found(
        way=way,
        tree_points_m=tuple((node.pose.x_m, node.pose.y_m) for node in tree.nodes),
        tree_parents=tuple(node.parent for node in tree.nodes),
        n_iterations=n_iterations,
    )


@dataclass(frozen=True, kw_only=True)
class _Node:
    pose: Pose2
    parent: int
    stage: Stage | None
    """Which led to it from its parent."""
    side: int | None


@dataclass
class _Tree:
    query: BoxPathQuery
    pushes: Pushes
    nodes: list[_Node] = field(default_factory=list)

    def __post_init__(self) -> None:
        query = self.query
        self._random = np.random.default_rng(query.seed)
        size_m = np.array([query.grid.n_columns, query.grid.n_rows]) * query.grid.resolution_m
        self._low = np.array([*query.grid.origin_m, -np.pi])
        self._high = np.array([*(np.array(query.grid.origin_m) + size_m), np.pi])
        self._poses = np.empty((query.max_iterations + 1, 3))
        self._add(_Node(pose=query.start, parent=0, stage=None, side=query.present_side))

    def grow(self) -> Way:
        """One iteration; all of the way once the goal is reached, else nothing."""
        target = self._sample()
        growths = [self._toward(index, target) for index in self._nearest(target)]
        _, index, stage = min(growths, key=lambda growth: growth[0])
        node = self.nodes[index]
        if not self.pushes.free((stage,), node.side):
            return ()
        self._add(_Node(pose=stage.end, parent=index, stage=stage, side=stage.side))
        last = self.pushes.best(self.pushes.to_goal(stage.end, self.query.goal), stage.side, inf, N_TO_GOAL)
        return () if last is None else (*self._way_to(len(self.nodes) - 1), *last)

    def _sample(self) -> Pose2:
        if self._random.random() < self.query.goal_bias:
            return self.query.goal
        x_m, y_m, yaw_rad = self._random.uniform(self._low, self._high).tolist()
        return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)

    def _nearest(self, target: Pose2) -> list[int]:
        poses = self._poses[: len(self.nodes)]
        turn = np.abs((poses[:, 2] - target.yaw_rad + np.pi) % (2 * np.pi) - np.pi)
        distance = np.hypot(*(poses[:, :2] - target.xy()).T) + TURN_M_PER_RAD * turn
        nearest: list[int] = np.argsort(distance, kind="stable")[:N_NEAREST].tolist()
        return nearest

    def _toward(self, index: int, target: Pose2) -> tuple[float, int, Stage]:
        """The cheapest push from a node, no longer than a step, and what all of it would cost."""
        node, pushes = self.nodes[index], self.pushes
        (best,) = min(pushes.singles(node.pose, target), key=lambda way: pushes.cost_m(way, node.side))
        cost_m = pushes.cost_m((best,), node.side)
        if best.length_m > self.query.step_m:
            end = pushes.sides[best.side].along(best.begin, best.end, self.query.step_m)
            best = Stage(side=best.side, begin=best.begin, end=end, length_m=self.query.step_m)
        return cost_m, index, best

    def _add(self, node: _Node) -> None:
        self._poses[len(self.nodes)] = node.pose.x_m, node.pose.y_m, node.pose.yaw_rad
        self.nodes.append(node)

    def _way_to(self, index: int) -> Way:
        stages: list[Stage] = []
        while (node := self.nodes[index]).stage is not None:
            stages.append(node.stage)
            index = node.parent
        return tuple(reversed(stages))


def _shortened(way: Way, query: BoxPathQuery, pushes: Pushes) -> Way:
    """The way with detours cut off: what lies between two of its poses is done directly where that is cheaper.

    The rest of a shortest push is the shortest push from where it is cut, so stages describe the way again.
    """
    random = np.random.default_rng(query.seed)
    for _ in range(N_SHORTCUTS):
        total_m = sum(stage.length_m for stage in way)
        low_m, high_m = sorted(random.uniform(0.0, total_m, size=2).tolist())
        before, rest = _cut(way, low_m, pushes)
        middle, after = _cut(rest, high_m - low_m, pushes)
        if random.random() < query.goal_bias:
            middle, after = rest, ()
        if not middle:
            continue
        side = before[-1].side if before else query.present_side
        begin, end = middle[0].begin, middle[-1].end
        ways = (*pushes.singles(begin, end), *pushes.doubles(begin, end)) if after else pushes.to_goal(begin, end)
        present_m = pushes.cost_m((*middle, *after), side)
        whole = ((*one, *after) for one in ways)
        shorter = pushes.best(whole, side, present_m - LEAST_GAIN_M, N_TO_GOAL)
        if shorter is not None:
            way = (*before, *shorter)
    return way


def _cut(way: Way, distance_m: float, pushes: Pushes) -> tuple[Way, Way]:
    """The way up to a distance, and the rest of it."""
    for index, stage in enumerate(way):
        if distance_m < stage.length_m:
            middle = pushes.sides[stage.side].along(stage.begin, stage.end, distance_m)
            first = Stage(side=stage.side, begin=stage.begin, end=middle, length_m=distance_m)
            second = Stage(side=stage.side, begin=middle, end=stage.end, length_m=stage.length_m - distance_m)
            return (*way[:index], *((first,) if distance_m > 0.0 else ())), (second, *way[index + 1 :])
        distance_m -= stage.length_m
    return way, ()


def _points(*poses: Pose2) -> tuple[Point2, ...]:
    return tuple((pose.x_m, pose.y_m) for pose in poses)
