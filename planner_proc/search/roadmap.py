"""PRM*: draws free places at random, joins each to its nearest ones, and finds the shortest way through them.

It is lazy: an edge is checked only when the shortest way leads along it. OMPL's own PRM* looks for a solution in a
second thread, so that equal seeds may give different paths; this one counts its samples.
"""

from collections.abc import Iterator
from math import ceil, e, log
from typing import Final

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from legpush.arrays import Floats, Integers
from legpush.geometry import Point2
from legpush.messages.planning import TrunkPathQuery
from legpush.plans.planner import Interrupted, PlanningInterruptedError
from planner_proc.clearance.field import ClearanceField
from planner_proc.search.route import Route

_NEIGHBOURS: Final = e * 1.5
"""Number of neighbours over the logarithm of the number of places: Karaman and Frazzoli's k-PRM* in the plane."""
_FIRST_PLACES: Final = 50
"""With `anytime`, how many samples to draw before the first look for a way; doubled until there is one."""
_DRAWN_AT_ONCE: Final = 5000
"""How many samples to draw together."""
MOST_SAMPLES: Final = 200_000
"""Most samples that a query may ask for: each takes some kilobytes, with its neighbours."""
_START, _GOAL = 0, 1
"""Indices of the start and the goal among the places."""


def roadmap_routes(query: TrunkPathQuery, field: ClearanceField, interrupted: Interrupted) -> Iterator[Route]:
    """Yield the shortest way through `max_iterations` samples and then, with `anytime`, through more and more samples.

    With `anytime`, the first way comes as soon as the goal is reached.

    Raises:
        PlanningInterruptedError: The routes are not wanted any more.
    """
    roadmap = _Roadmap(query, field, interrupted)
    if query.anytime is None:
        roadmap.sample(query.max_iterations)
        yield roadmap.route()
        return
    n = min(_FIRST_PLACES, query.max_iterations)
    roadmap.sample(n)
    route = roadmap.route()
    while not route.reached and n < query.max_iterations:
        more = min(n, query.max_iterations - n)
        roadmap.sample(more)
        n += more
        route = roadmap.route()
    yield route
    for _ in range(query.anytime.n_improvements):
        roadmap.sample(query.anytime.improvement_iterations)
        yield roadmap.route()


class _Roadmap:
    """Places, of which the first two are the start and the goal, and which lines between them are known to be free."""

    def __init__(self, query: TrunkPathQuery, field: ClearanceField, interrupted: Interrupted) -> None:
        self._query = query
        self._field = field
        self._interrupted = interrupted
        self._random = np.random.default_rng(query.seed)
        low = np.array(query.grid.origin_m)
        self._low, self._high = low, low + np.array(field.size_m)
        self._places_m = np.array([[pose.x_m, pose.y_m] for pose in (query.start, query.goal)])
        self._is_free: dict[tuple[int, int], bool] = {}
        self._n_samples = 0

    def sample(self, n: int) -> None:
        """Draw `n` places and keep the free ones."""
        while n > 0:
            if self._interrupted():
                raise PlanningInterruptedError
            drawn = self._random.uniform(self._low, self._high, size=(min(n, _DRAWN_AT_ONCE), 2))
            free = self._field.bounds_m(drawn) >= self._query.clearance_m
            unsure = np.flatnonzero(~free)
            free[unsure] = self._field.clearance_m(drawn[unsure]) >= self._query.clearance_m
            self._places_m = np.concatenate([self._places_m, drawn[free]])
            self._n_samples += len(drawn)
            n -= len(drawn)

    def route(self) -> Route:
        """The shortest free way to the goal or, if there is none, to the reachable place nearest to the goal."""
        a, b, lengths_m = self._lines()
        known = np.array([self._is_free.get(pair, True) for pair in zip(a.tolist(), b.tolist(), strict=True)])
        a, b, lengths_m = a[known], b[known], lengths_m[known]
        index = {pair: k for k, pair in enumerate(zip(a.tolist(), b.tolist(), strict=True))}
        while True:
            if self._interrupted():
                raise PlanningInterruptedError
            distances_m, before = self._shortest(a, b, lengths_m)
            target = _GOAL
            if not np.isfinite(distances_m[_GOAL]):
                to_goal_m = np.hypot(*(self._places_m - self._places_m[_GOAL]).T)
                target = int(np.where(np.isfinite(distances_m), to_goal_m, np.inf).argmin())
            way = _way(before, target)
            blocked = [pair for pair in map(_sorted, way[:-1], way[1:]) if not self._joined(pair)]
            if not blocked:
                return self._as_route(way, before, reached=target == _GOAL)
            lengths_m[[index[pair] for pair in blocked]] = np.inf

    def _lines(self) -> tuple[Integers, Integers, Floats]:
        """Lines from each place to its nearest ones: the lower index, the higher one, and the length, (n,) each."""
        n = len(self._places_m)
        k = min(n - 1, max(1, ceil(_NEIGHBOURS * log(n))))
        apart_m, nearest = (np.asarray(each) for each in cKDTree(self._places_m).query(self._places_m, k=k + 1))
        here = np.repeat(np.arange(n), k)
        there = nearest[:, 1:].ravel()
        pairs = np.stack([np.minimum(here, there), np.maximum(here, there)])
        pairs, first = np.unique(pairs, axis=1, return_index=True)
        return pairs[0], pairs[1], apart_m[:, 1:].ravel()[first]

    def _shortest(self, a: Integers, b: Integers, lengths_m: Floats) -> tuple[Floats, list[int]]:
        """Distance from the start to each place, (n,), and the place before it on the shortest way."""
        usable = np.isfinite(lengths_m)
        n = len(self._places_m)
        graph = csr_array((lengths_m[usable], (a[usable], b[usable])), shape=(n, n))
        distances_m, before = dijkstra(graph, directed=False, indices=np.array([_START]), return_predecessors=True)
        came_from: list[int] = np.asarray(before)[0].tolist()
        return np.asarray(distances_m)[0], came_from

    def _joined(self, pair: tuple[int, int]) -> bool:
        """Whether the line between two places is free."""
        if pair not in self._is_free:
            a_m, b_m = self._places_m[list(pair)].tolist()
            self._is_free[pair] = self._field.segment_is_free(a_m, b_m, self._query.clearance_m)
        return self._is_free[pair]

    def _as_route(self, way: list[int], before: list[int], *, reached: bool) -> Route:
        """A way as a route, with the part of the tree of shortest ways whose lines are known to be free."""
        order, parents, place = [_START], [0], {_START: 0}
        for node in sorted(range(len(before)), key=lambda node: _depth(before, node)):
            parent = before[node]
            if node not in place and parent in place and self._is_free.get(_sorted(parent, node), False):
                place[node] = len(order)
                order.append(node)
                parents.append(place[parent])
        points: list[Point2] = [(x_m, y_m) for x_m, y_m in self._places_m[order].tolist()]
        return Route(
            reached=reached,
            points_m=self._places_m[way],
            curve=None,
            tree_points_m=tuple(points),
            tree_parents=tuple(parents),
            n_iterations=self._n_samples,
        )


def _way(before: list[int], target: int) -> list[int]:
    """Places on the way from the start to a place, given the place before each."""
    way = [target]
    while way[-1] != _START:
        way.append(before[way[-1]])
    return way[::-1]


def _depth(before: list[int], node: int) -> int:
    """Number of lines between the start and a place; that of all places if it cannot be reached."""
    depth = 0
    while node != _START:
        node = before[node]
        depth += 1
        if node < 0:
            return len(before)
    return depth


def _sorted(one: int, other: int) -> tuple[int, int]:
    return min(one, other), max(one, other)
