"""How many rectangles on the floor lie over one another."""

from collections.abc import Sequence

import numpy as np

Sides = tuple[float, float, float, float]
"""Least and largest x, least and largest y of a rectangle along the axes."""


def deepest_overlap(rectangles: Sequence[Sides]) -> int:
    """Return the largest number of rectangles that share a place; those that only touch share none.

    A line sweeps along x. Between two values of y it counts the rectangles that it is in: one more where a rectangle
    begins, one less where it ends.
    """
    if not rectangles:
        return 0
    x_low, x_high, y_low, y_high = np.array(rectangles).T
    values = np.unique([y_low, y_high])
    first, last = np.searchsorted(values, y_low), np.searchsorted(values, y_high)
    begins = np.repeat([False, True], len(rectangles))
    index = np.tile(np.arange(len(rectangles)), 2)
    counts, most = np.zeros(len(values), dtype=np.int64), 0
    for event in np.lexsort((begins, np.concatenate([x_high, x_low]))).tolist():
        covered = counts[first[index[event]] : last[index[event]]]
        covered += 1 if begins[event] else -1
        most = max(most, int(covered.max()))
    return most
