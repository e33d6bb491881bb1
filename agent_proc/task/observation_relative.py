"""The profile `relative`: the box in the frame of its goal, always left of the line.

Where the leading edge of the box is right of the line through the goal, every element is that of the mirror image: y
and angles change their sign. What was learned on one side holds on the other. The robot itself is not observed: every
push cycle ends at the station. The exact pose of trunk and feet reveals which leg pushed last. A policy that sees it
learns to alternate legs, and fails where the posture differs, for example on a slope.
"""

from collections.abc import Callable
from math import degrees, pi, radians
from typing import Final

import numpy as np

from agent_proc.frames.push_view import LOOK_AHEAD_M, PushView
from agent_proc.task.observation_table import BEYOND_M, Entry, Table
from legpush.arrays import Floats
from legpush.scene.scenario import Scenario

NEAR_M: Final = 0.05
"""From about this length on, `box_near` grows with the logarithm of a distance."""
NEAR_RAD: Final = radians(1.0)
"""The same of an angle, for `heading_near`."""
FAR_M: Final = 1.0
"""A box that is farther short of its goal is observed at this distance."""


def _box(view: PushView) -> Floats:
    return np.array([max(view.box_g.x_m, -FAR_M), view.mirror_sign * view.box_g.y_m])


def _headings(view: PushView) -> Floats:
    return view.mirror_sign * np.array([view.box_g.yaw_rad, view.steering_error_rad])


def _distance_limits(scenario: Scenario) -> tuple[Floats, Floats]:
    high = np.full(2, np.hypot(*scenario.room.size_m) + BEYOND_M)
    return -high, high


def _near_limits(scenario: Scenario) -> tuple[Floats, Floats]:
    low, high = _distance_limits(scenario)
    return np.arcsinh(low / NEAR_M), np.arcsinh(high / NEAR_M)


def _limits(*high: float) -> Callable[[Scenario], tuple[Floats, Floats]]:
    return lambda _: (-np.array(high), np.array(high))


RELATIVE: Final[Table] = (
    Entry(
        name="box",
        axes="xy",
        size=2,
        read=_box,
        meaning=f"centre of the box; x is minus the distance that remains, {FAR_M:g} m at most",
        frame="goal",
        limits=_distance_limits,
    ),
    Entry(
        name="box_near",
        axes="xy",
        size=2,
        read=lambda view: np.arcsinh(_box(view) / NEAR_M),
        meaning=f"asinh of the same over {NEAR_M:g} m: the last centimetres count most",
        unit="1",
        frame="goal",
        limits=_near_limits,
    ),
    Entry(
        name="heading",
        axes="yaw, steering",
        size=2,
        read=_headings,
        meaning=f"heading of the box, and that less the one toward the goal's line {LOOK_AHEAD_M:g} m ahead",
        unit="rad",
        frame="goal",
        limits=_limits(pi, pi),
    ),
    Entry(
        name="heading_near",
        axes="yaw, steering",
        size=2,
        read=lambda view: np.arcsinh(_headings(view) / NEAR_RAD),
        meaning=f"asinh of the same over {degrees(NEAR_RAD):g}°",
        unit="1",
        frame="goal",
        limits=_limits(*(float(np.arcsinh(pi / NEAR_RAD)),) * 2),
    ),
)
"""8 elements, in the frame of the goal, mirrored where needed."""
