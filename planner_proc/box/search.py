"""Two trees of pushes (RRT), from where the box is and back from its goal, grown until they meet, and what was found
made shorter.
"""

from dataclasses import dataclass
from math import inf
from typing import Final

import numpy as np

from legpush.geometry import Pose2
from legpush.messages.common import MAX_WAYPOINTS, Point2
from legpush.messages.planning import BoxPathQuery
from legpush.plans.request_queue import Interrupted, PlanningInterruptedError
from planner_proc.box.pushes import Pushes, Stage, Way
from planner_proc.search_tree import thin

TURN_M_PER_RAD: Final = 0.5
"""What a difference in heading counts, for which node of the tree is nearest."""
N_NEAREST: Final = 4
"""Nodes that are near enough to grow from; the cheapest push decides."""
N_DIRECT: Final = 12
"""Ways from start to goal that are tried before a tree is grown, cheapest first."""
N_TO_GOAL: Final = 3
"""The same from each node that the start leads to."""
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
    shorter = [_shortened(way, query, pushes) for way in ways[:N_SHORTENED]]
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


@dataclass(frozen=True, kw_only=True)
class _Node:
    pose: Pose2
    parent: int | None
    """None of a root."""
    stage: Stage | None
    """Between it and its parent, of a root that leads to the goal to there; None of the start."""
    side: int | None
    """From the start: the one that the robot stands at. To the goal: the one from which pushing goes on."""


class _Tree:
    """Poses that the start leads to or, `backward`, that lead to the goal, and the pushes between them."""

    def __init__(self, pushes: Pushes, size: int, *, backward: bool) -> None:
        self.nodes: list[_Node] = []
        self._pushes = pushes
        self._poses = np.empty((size, 3))
        self._backward = backward

    def add(self, node: _Node) -> _Node:
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

    def grow(self, target: Pose2, step_m: float) -> _Node | None:
        """The cheapest push between a near node and the target, no longer than a step, added if it is free."""
        candidates = [self._candidate(index, target) for index in self.nearest(target, N_NEAREST)]
        _, index, stage = min(candidates, key=lambda candidate: candidate[0])
        stage, node = self._cut(stage, step_m), self.nodes[index]
        if not self._pushes.free(self._with_next(stage, index), stage.side if self._backward else node.side):
            return None
        pose = stage.begin if self._backward else stage.end
        return self.add(_Node(pose=pose, parent=index, stage=stage, side=stage.side))

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
        (best,) = min(pushes.singles(*ends), key=lambda way: pushes.cost_m(way, node.side))
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
        self.forward, self._backward = (_Tree(pushes, size, backward=backward) for backward in (False, True))
        self.forward.add(_Node(pose=query.start, parent=None, stage=None, side=query.present_side))
        for index in range(len(pushes.sides)):
            for stage in self._run_ins(index):
                self._backward.add(_Node(pose=stage.begin, parent=None, stage=stage, side=index))

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
            ways = (*self._pushes.singles(a.pose, b.pose), *self._pushes.doubles(a.pose, b.pose))
            found = self._pushes.best(iter([(*way, *after) for way in ways]), a.side, inf, N_JOINS_TRIED)
            if found is not None:
                return (*self.forward.way(begin), *found[:-1], *self._backward.way(end))
        return ()


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
