"""The cheapest motion of the body on a lattice of places and headings about the start."""

from dataclasses import dataclass
from math import hypot, pi
from typing import Final

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from legpush.arrays import Flags, Floats, Integers
from planner_proc.body.motion import effort, turn_rad
from planner_proc.body.space import BodySpace

N_HEADINGS: Final = 32
HEADING_RAD: Final = 2 * pi / N_HEADINGS
LEAST_STEP_M: Final = 0.1
MOVES: Final = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1))
"""Steps along the axes of the lattice, which are those of the start."""
EXACT_WITHIN_M: Final = 0.5
"""Nodes that are nearer to the start or the goal are measured exactly: there the robot may stand close to a wall."""
MOST_PLACES: Final = 50_000
"""A lattice with more places, as along a way of hundreds of metres, takes minutes and gigabytes: it is not searched."""
MOST_REPAIRS: Final = 24
"""How many motions to find whose steps are free, but not all that lies between them, before giving up."""
SLACKS_M: Final = (0.02, 0.0)
"""Clearance to ask of the nodes beyond what is required; more makes it likely that the steps between them are free."""


@dataclass(frozen=True, kw_only=True)
class _Graph:
    """Nodes are pairs of a place and a heading: place times `N_HEADINGS` plus heading."""

    points_m: Floats
    """Places, (n, 2), the start first."""
    steps: csr_matrix
    """Costs of steps between nodes."""


def search(space: BodySpace, start: Floats, goal: Floats, along_m: Floats, within_m: float, step_m: float) -> Floats:
    """The cheapest motion from start to goal, (3,) each, as poses (n, 3); empty if there is none on the lattice.

    It is empty, too, if the lattice has more than `MOST_PLACES` places.
    Places are at most `within_m` from a line of points, (k, 2).
    """
    points_m, cells = _places(start, along_m, within_m, step_m)
    if len(points_m) > MOST_PLACES:
        return np.empty((0, 3))
    for slack_m in SLACKS_M:
        free, between = _free(space, points_m, start, goal, slack_m)
        free[0, 0] = True
        for _ in range(MOST_REPAIRS):
            graph = _Graph(points_m=points_m, steps=_steps(cells, free, between, space.reach_m, step_m))
            places, headings = _cheapest(graph, start, goal, space.reach_m, step_m)
            if not len(places):
                break
            poses = np.column_stack([points_m[places], start[2] + HEADING_RAD * headings])
            poses = np.concatenate([poses, goal[None]])
            faulty = np.flatnonzero(space.faults(poses))
            if not len(faulty):
                return poses
            both = np.unique(np.concatenate([faulty, faulty + 1]))
            nodes = both[(both > 0) & (both < len(places))]
            if not len(nodes):
                break
            free[places[nodes], headings[nodes]] = False
    return np.empty((0, 3))


def _places(start: Floats, along_m: Floats, within_m: float, step_m: float) -> tuple[Floats, Integers]:
    """Places of the lattice near a line of points, (n, 2), and their cells, (n, 2); the start is the first."""
    c, s = np.cos(start[2]), np.sin(start[2])
    axes = np.array([[c, s], [-s, c]]) * step_m
    seen = (along_m - start[:2]) @ np.linalg.inv(axes)
    reach = int(np.ceil(within_m / step_m))
    low = np.floor(seen.min(axis=0)).astype(int) - reach
    high = np.ceil(seen.max(axis=0)).astype(int) + reach
    columns, rows = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    cells = np.stack([columns.ravel(), rows.ravel()], axis=1)
    cells = np.concatenate([[[0, 0]], cells[(cells != 0).any(axis=1)]])
    points_m = start[:2] + cells @ axes
    away_m: Floats = np.asarray(cKDTree(along_m).query(points_m)[0])
    near = away_m <= within_m
    near[0] = True
    return points_m[near], cells[near]


def _free(space: BodySpace, points_m: Floats, start: Floats, goal: Floats, slack_m: float) -> tuple[Flags, Flags]:
    """Which headings are free at each place, and which in the middle of a turn to the next one, (n, headings) each."""
    ends: Flags = np.minimum(*(np.hypot(*(points_m - end[:2]).T) for end in (start, goal))) < EXACT_WITHIN_M
    disc = space.disc_is_free(points_m, slack_m)
    disc[ends] |= space.disc_is_free(points_m[ends], 0.0)
    flags = np.zeros((len(points_m), 2 * N_HEADINGS), dtype=np.bool_)
    for half in range(2 * N_HEADINGS):
        yaw_rad = start[2] + HEADING_RAD / 2 * half
        some = np.flatnonzero(disc)
        flags[some, half] = space.body_seems_free(points_m[some], yaw_rad, slack_m)
        doubtful = np.flatnonzero(disc & ends & ~flags[:, half])
        poses = np.column_stack([points_m[doubtful], np.full(len(doubtful), yaw_rad)])
        flags[doubtful, half] = space.body_is_free(poses)
    return flags[:, ::2].copy(), flags[:, 1::2]


def _steps(cells: Integers, free: Flags, between: Flags, turn_m: float, step_m: float) -> csr_matrix:
    """Costs of all steps between free nodes."""
    n = len(cells)
    low = cells.min(axis=0)
    shape = cells.max(axis=0) - low + 3
    index = np.full(shape, -1)
    at = cells - low + 1
    index[at[:, 0], at[:, 1]] = np.arange(n)
    headings = np.arange(N_HEADINGS)
    rows, columns, costs = [], [], []
    for dx, dy in MOVES:
        other = index[at[:, 0] + dx, at[:, 1] + dy]
        begins = np.flatnonzero(other >= 0)
        ends = other[begins]
        place, heading = np.nonzero(free[begins] & free[ends])
        rows.append(begins[place] * N_HEADINGS + heading)
        columns.append(ends[place] * N_HEADINGS + heading)
        factor = effort(np.arctan2(dy, dx) - HEADING_RAD * headings)
        costs.append(step_m * hypot(dx, dy) * factor[heading])
    for turn in (1, -1):
        middle = between if turn == 1 else np.roll(between, 1, axis=1)
        place, heading = np.nonzero(free & np.roll(free, -turn, axis=1) & middle)
        rows.append(place * N_HEADINGS + heading)
        columns.append(place * N_HEADINGS + (heading + turn) % N_HEADINGS)
        costs.append(np.full(len(place), turn_m * HEADING_RAD))
    entries = (np.concatenate(costs), (np.concatenate(rows), np.concatenate(columns)))
    return coo_matrix(entries, shape=(n * N_HEADINGS, n * N_HEADINGS)).tocsr()


def _cheapest(graph: _Graph, start: Floats, goal: Floats, turn_m: float, step_m: float) -> tuple[Integers, Integers]:
    """Places and headings of the cheapest motion to a node that is one short step from the goal, if there is one."""
    costs, before = dijkstra(graph.steps, indices=np.array(0), return_predecessors=True)
    away_m = np.hypot(*(graph.points_m - goal[:2]).T)
    best, best_cost = -1, np.inf
    for place in np.flatnonzero(away_m <= step_m).tolist():
        for heading in range(N_HEADINGS):
            off_rad = abs(turn_rad(start[2] + HEADING_RAD * heading, float(goal[2])))
            node = place * N_HEADINGS + heading
            if off_rad > 1.01 * HEADING_RAD:
                continue
            cost = costs[node] + 2 * away_m[place] + turn_m * off_rad
            if cost < best_cost:
                best, best_cost = node, cost
    nodes: list[int] = []
    while best >= 0:
        nodes.append(best)
        best = int(before[best])
    return np.divmod(np.array(nodes[::-1], dtype=np.int64), N_HEADINGS)
