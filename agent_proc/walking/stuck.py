"""Whether a robot gets on along its path."""

from collections.abc import Sequence
from itertools import pairwise
from math import inf
from typing import Final

from legpush.geometry import Pose2, distance_m
from legpush.scene.paths import path_length_m

STILL_CYCLES: Final = 5
"""The robot is stuck if this many cycles in a row change too little."""
LEAST_WALK_M: Final = 0.02
"""It is too little if the trunk, or its place on the path, moves less than this in all of them together."""
THROWN_CYCLES: Final = 30
"""As many must change too little where the robot moves to and fro, as gusts throw it back."""
TO_AND_FRO_M: Final = 0.1
"""It does if a cycle moved it by more than this."""


def is_stuck(past: Sequence[tuple[Pose2, float]], foot_circle_m: float) -> bool:
    """Whether the robot is where it was some gait cycles ago, by its trunk or by its place on the path."""
    for n_cycles, most_m in ((STILL_CYCLES, TO_AND_FRO_M), (THROWN_CYCLES, inf)):
        if len(past) <= n_cycles:
            return False
        (then, then_m), (now, now_m) = past[-1 - n_cycles], past[-1]
        moved_m = min(path_length_m((then, now), foot_circle_m), now_m - then_m)
        steps_m = [distance_m(a, b) for (a, _), (b, _) in pairwise(list(past)[-1 - n_cycles :])]
        if moved_m < LEAST_WALK_M and max(steps_m) <= most_m:
            return True
    return False
