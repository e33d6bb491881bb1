"""Searches a path of the box with two random trees of pushes (RRT), one from the start and one back from the goal."""

from dataclasses import dataclass
from math import inf
from typing import Final

import numpy as np

from legpush.bounds import MAX_WAYPOINTS
from legpush.geometry import Point2, Pose2
from legpush.messages.planning import BoxPathQuery
from legpush.plans.planner import Interrupted, PlanningInterruptedError
from planner_proc.box.pushes import Pushes, Stage, Way
from planner_proc.box.shortening import shortened
from planner_proc.box.tree import Node, Tree
from planner_proc.search_tree import thin

N_DIRECT: Final = 12
"""How many ways from start to goal to try before growing trees, cheapest first."""
N_TO_GOAL: Final = 3
"""How many ways to the goal to try from each new node of the tree from the start, cheapest first."""
N_JOINED: Final = 3
"""How many nodes of the other tree to try to join each new node to, nearest first."""
N_JOINS_TRIED: Final = 2
"""How many ways to try between two such nodes, cheapest first."""
LEAST_RUN_IN_M: Final = 0.1
"""Run-in to assume if the query asks for a shorter one."""
RUN_IN_SHARES: Final = (1.0, 0.75, 0.5, 0.25)
"""Lengths of the straight pushes with which the tree to the goal may begin, as shares of the run-in."""
FIRST_TREES: Final = 300
MOST_TREES: Final = 600
"""Restart the trees if they have not met after this many iterations, then after as many more as went before, at most
`MOST_TREES`: a search either succeeds early or is stuck with poor first pushes.
"""
MORE: Final = 2
LEAST_MORE: Final = 80
"""A way found after n iterations ends the search after MORE * n + LEAST_MORE of them: a cheaper way may turn up."""
N_SHORTENED: Final = 3
"""How many of the ways found to shorten, cheapest first."""


@dataclass(frozen=True, kw_only=True)
class Found:
    """Result of a search."""

    way: Way
    """Empty if none was found."""
    tree_points_m: tuple[Point2, ...]
    """Positions of the nodes of the tree from the start."""
    tree_parents: tuple[int, ...]
    """Index of each node's parent; a root is its own parent."""
    n_iterations: int


def search(query: BoxPathQuery, pushes: Pushes, interrupted: Interrupted) -> Found:
    """Find the cheapest direct way that is free or, if there is none, a way through the two trees.

    Equal queries get equal results.

    Raises:
        PlanningInterruptedError: The result is not wanted any more.
    """
    direct = pushes.best(pushes.to_goal(query.start, query.goal), query.present_side, inf, N_DIRECT)
    if direct is not None:
        return Found(way=direct, tree_points_m=_points(query.start, query.goal), tree_parents=(0, 0), n_iterations=0)
    tree, ways, n_iterations = _grow(query, pushes, interrupted)
    ways.sort(key=lambda way: pushes.cost_m(way, query.present_side))
    shorter = [shortened(way, query, pushes) for way in ways[:N_SHORTENED]]
    way = min(shorter, key=lambda way: pushes.cost_m(way, query.present_side), default=())
    points, parents = thin(
        [(node.pose.x_m, node.pose.y_m) for node in tree.nodes],
        [k if node.parent is None else node.parent for k, node in enumerate(tree.nodes)],
        MAX_WAYPOINTS,
    )
    return Found(way=way, tree_points_m=tuple(points), tree_parents=tuple(parents), n_iterations=n_iterations)


def _grow(query: BoxPathQuery, pushes: Pushes, interrupted: Interrupted) -> tuple[Tree, list[Way], int]:
    """Grow trees until the iterations are used up: the last tree from the start, all ways found, and how many
    iterations that took.
    """
    random = np.random.default_rng(query.seed)
    trees = _TwoTrees(query, pushes, random)
    ways: list[Way] = []
    n_iterations, n_wanted, patience = 0, query.max_iterations, FIRST_TREES
    while n_iterations < n_wanted:
        n_iterations += 1
        if interrupted():
            raise PlanningInterruptedError
        if not ways and n_iterations > patience:
            patience += min(patience, MOST_TREES)
            trees = _TwoTrees(query, pushes, random)
        way = trees.iterate(n_iterations)
        if way:
            ways.append(way)
            n_wanted = min(n_wanted, MORE * n_iterations + LEAST_MORE)
    return trees.forward, ways, n_iterations


class _TwoTrees:
    """A tree from the start and a tree to the goal, and the ways that join them."""

    def __init__(self, query: BoxPathQuery, pushes: Pushes, random: np.random.Generator) -> None:
        """Begin with the start, and with straight pushes into the goal."""
        self._query = query
        self._pushes = pushes
        self._random = random
        size_m = np.array([query.grid.n_columns, query.grid.n_rows]) * query.grid.resolution_m
        self._low = np.array([*query.grid.origin_m, -np.pi])
        self._high = np.array([*(np.array(query.grid.origin_m) + size_m), np.pi])
        size = query.max_iterations + 1 + len(RUN_IN_SHARES) * len(pushes.sides)
        self.forward, self._backward = (Tree(pushes, size, backward=backward) for backward in (False, True))
        self.forward.add(Node(pose=query.start, parent=None, stage=None, side=query.present_side))
        for index in range(len(pushes.sides)):
            for stage in self._run_ins(index):
                self._backward.add(Node(pose=stage.begin, parent=None, stage=stage, side=index))

    def _run_ins(self, side: int) -> list[Stage]:
        """Straight pushes into the goal from a side.

        One is as long as the run-in. If the robot has no room to stand where it begins, the longest of the shorter ones
        where it has room is added.
        """
        whole_m, found = max(self._query.run_in_m, LEAST_RUN_IN_M), []
        for share in RUN_IN_SHARES:
            before = self._pushes.sides[side].ahead(self._query.goal, -share * whole_m)
            stage = self._pushes.stage(side, before, self._query.goal)
            can_begin = self._pushes.sides[side].can_begin(before)
            if (can_begin or share == 1.0) and self._pushes.free((stage,), side):
                found.append(stage)
            if can_begin:
                break
        return found

    def iterate(self, n: int) -> Way:
        """Grow one tree, in turn, and try to complete a way over its new node; empty if there is none."""
        if n % 2 and self._backward.nodes:
            grown = self._backward.grow(self._sample(self._query.start), self._query.step_m)
            return self._join(len(self._backward.nodes) - 1, forward=False) if grown else ()
        node = self.forward.grow(self._sample(self._query.goal), self._query.step_m)
        if node is None:
            return ()
        index = len(self.forward.nodes) - 1
        last = self._pushes.best(self._pushes.to_goal(node.pose, self._query.goal), node.side, inf, N_TO_GOAL)
        return self._join(index, forward=True) if last is None else (*self.forward.way(index), *last)

    def _sample(self, toward: Pose2) -> Pose2:
        """A random pose or, with the probability `goal_bias`, the pose at which the other tree begins."""
        if self._random.random() < self._query.goal_bias:
            return toward
        x_m, y_m, yaw_rad = self._random.uniform(self._low, self._high).tolist()
        return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)

    def _join(self, index: int, *, forward: bool) -> Way:
        """A free way over a new node of one tree and a node near it of the other; empty if there is none."""
        mine, others = (self.forward, self._backward) if forward else (self._backward, self.forward)
        for other in others.nearest(mine.nodes[index].pose, N_JOINED):
            begin, end = (index, other) if forward else (other, index)
            a, b = self.forward.nodes[begin], self._backward.nodes[end]
            after = () if b.stage is None else (b.stage,)
            ways = (*self._pushes.one_side(a.pose, b.pose), *self._pushes.two_sides(a.pose, b.pose))
            found = self._pushes.best(iter([(*way, *after) for way in ways]), a.side, inf, N_JOINS_TRIED)
            if found is not None:
                return (*self.forward.way(begin), *found[:-1], *self._backward.way(end))
        return ()


def _points(*poses: Pose2) -> tuple[Point2, ...]:
    return tuple((pose.x_m, pose.y_m) for pose in poses)
