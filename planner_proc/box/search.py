"""Two trees of pushes (RRT), from where the box is and back from its goal, grown until they meet, and what was found
made shorter.
"""

from dataclasses import dataclass
from math import inf
from typing import Final

import numpy as np

from legpush.geometry import Point2, Pose2
from legpush.messages.common import MAX_WAYPOINTS
from legpush.messages.planning import BoxPathQuery
from legpush.plans.planner import Interrupted, PlanningInterruptedError
from planner_proc.box.pushes import Pushes, Stage, Way
from planner_proc.box.shortening import N_TO_GOAL, shortened
from planner_proc.box.tree import Node, Tree
from planner_proc.search_tree import thin

N_DIRECT: Final = 12
"""Ways from start to goal that are tried before a tree is grown, cheapest first."""
LEAST_RUN_IN_M: Final = 0.1
RUN_IN_SHARES: Final = (1.0, 0.75, 0.5, 0.25)
"""The tree that leads to the goal begins with straight pushes into it: of what is asked for, and of shares of that."""
N_JOINED: Final = 3
"""Nodes of the other tree that a new one is joined to, if that is free."""
N_JOINS_TRIED: Final = 2
"""Ways between two nodes that are tried, cheapest first."""
FIRST_TREES: Final = 300
"""Trees that have not met after so many iterations are begun anew, after twice as many the next time: most find a way
soon or hardly ever, as their first pushes fell.
"""
MORE: Final = 2
LEAST_MORE: Final = 80
"""Once the goal is reached, the trees grow on for as many iterations again, and some: a cheaper way may show up."""
N_SHORTENED: Final = 3
"""Of what was found, so many of the cheapest are made shorter."""


@dataclass(frozen=True, kw_only=True)
class Found:
    """What the search found, if anything."""

    way: Way
    """Empty where nothing was found."""
    tree_points_m: tuple[Point2, ...]
    tree_parents: tuple[int, ...]
    n_iterations: int


def search(query: BoxPathQuery, pushes: Pushes, interrupted: Interrupted) -> Found:
    """The cheapest direct way that fits; else what the trees come to. Equal queries get equal answers.

    `PlanningInterruptedError` where the answer is not wanted any more.
    """
    direct = pushes.best(pushes.to_goal(query.start, query.goal), query.present_side, inf, N_DIRECT)
    if direct is not None:
        return Found(way=direct, tree_points_m=_points(query.start, query.goal), tree_parents=(0, 0), n_iterations=0)
    random = np.random.default_rng(query.seed)
    trees = _Search(query, pushes, random)
    ways: list[Way] = []
    n_iterations, n_wanted, patience = 0, query.max_iterations, FIRST_TREES
    while n_iterations < n_wanted:
        n_iterations += 1
        if interrupted():
            raise PlanningInterruptedError
        if not ways and n_iterations > patience:
            patience *= 2
            trees = _Search(query, pushes, random)
        way = trees.iterate(n_iterations)
        if way:
            ways.append(way)
            n_wanted = min(n_wanted, MORE * n_iterations + LEAST_MORE)
    ways.sort(key=lambda way: pushes.cost_m(way, query.present_side))
    shorter = [shortened(way, query, pushes) for way in ways[:N_SHORTENED]]
    way = min(shorter, key=lambda way: pushes.cost_m(way, query.present_side), default=())
    nodes = trees.forward.nodes
    points, parents = thin(
        [(node.pose.x_m, node.pose.y_m) for node in nodes],
        [k if node.parent is None else node.parent for k, node in enumerate(nodes)],
        MAX_WAYPOINTS,
    )
    return Found(
        way=way,
        tree_points_m=tuple(points),
        tree_parents=tuple(parents),
        n_iterations=n_iterations,
    )


class _Search:
    """Both trees, and the ways that join them."""

    def __init__(self, query: BoxPathQuery, pushes: Pushes, random: np.random.Generator) -> None:
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
        """Straight pushes into the goal from a side: as long as asked for and, if the robot cannot come to stand where
        that begins, also one that begins where it can.
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
        """The n-th iteration, of the one tree and the other in turn; a whole way where it found one, else nothing."""
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
        """Anywhere or, as often as the goal bias says, where the other tree begins."""
        if self._random.random() < self._query.goal_bias:
            return toward
        x_m, y_m, yaw_rad = self._random.uniform(self._low, self._high).tolist()
        return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)

    def _join(self, index: int, *, forward: bool) -> Way:
        """A way over a new node of one tree and a node near it of the other, if a free one was found."""
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
