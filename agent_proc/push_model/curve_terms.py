"""How the weights w1 and w2 of a push change what it does: a quadratic polynomial of them, times the depth."""

from typing import Final

import numpy as np

from legpush.arrays import Floats

CENTRE: Final = 0.5
"""The value of w1 and w2 from which they are measured."""
CURVE_TERMS: Final = ("w1", "w2", "w1 w1", "w1 w2", "w2 w2")
"""The terms of the polynomial."""
Terms = tuple[float, float, float, float, float]
"""One number for each of `CURVE_TERMS`."""


def curve_terms(w1: Floats, w2: Floats) -> tuple[Floats, ...]:
    """The values of `CURVE_TERMS`, (n,) each."""
    a, b = np.asarray(w1) - CENTRE, np.asarray(w2) - CENTRE
    return a, b, a * a, a * b, b * b
