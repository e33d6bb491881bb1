"""Shortens a sequence of pushes by random shortcuts."""

from typing import Final

import numpy as np

from legpush.messages.planning import BoxPathQuery
from planner_proc.box.pushes import Pushes, Stage, Way

N_SHORTCUTS: Final = 80
"""How many shortcuts to try."""
N_TRIED: Final = 3
"""How many ways to try for each shortcut, cheapest first."""
LEAST_GAIN_M: Final = 0.01
"""A shortcut must lower the cost by at least this much."""


def shortened(way: Way, query: BoxPathQuery, pushes: Pushes) -> Way:
    """Replace parts of a way, between two of its poses drawn at random, by direct pushes where these are cheaper.

    The rest of a shortest push is itself the shortest push from where it is cut, so the result again consists of
    stages.
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
        ways = (*pushes.one_side(begin, end), *pushes.two_sides(begin, end)) if after else pushes.to_goal(begin, end)
        present_m = pushes.cost_m((*middle, *after), side)
        whole = ((*one, *after) for one in ways)
        shorter = pushes.best(whole, side, present_m - LEAST_GAIN_M, N_TRIED)
        if shorter is not None:
            way = (*before, *shorter)
    return way


def _cut(way: Way, distance_m: float, pushes: Pushes) -> tuple[Way, Way]:
    """The way up to a distance along it, and the rest."""
    for index, stage in enumerate(way):
        if distance_m < stage.length_m:
            middle = pushes.sides[stage.side].along(stage.begin, stage.end, distance_m)
            first = Stage(side=stage.side, begin=stage.begin, end=middle, length_m=distance_m)
            second = Stage(side=stage.side, begin=middle, end=stage.end, length_m=stage.length_m - distance_m)
            return (*way[:index], *((first,) if distance_m > 0.0 else ())), (second, *way[index + 1 :])
        distance_m -= stage.length_m
    return way, ()
