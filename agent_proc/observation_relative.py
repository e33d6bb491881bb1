"""The profile `relative`: the box as its goal sees it and the robot as the box sees it, box always left of the line.

Where the leading edge of the box is right of the line through the goal, every element is that of the mirror image: y
and angles change their sign, left and right legs their places. What was learned on one side holds on the other.
"""

from collections.abc import Callable
from math import degrees, pi, radians
from typing import Final

import numpy as np

from agent_proc.goal_frame import LOOK_AHEAD_M, box_in_goal_frame, mirror_sign, steering_error_rad
from agent_proc.observation import BEYOND_M, Entry, Floats, Table
from agent_proc.poses import planar_pose
from agent_proc.station import station
from legpush.messages import WorldState
from legpush.scenario import Scenario

NEAR_M: Final = 0.05
"""From about this length on, `box_near` grows with the logarithm of a distance."""
NEAR_RAD: Final = radians(1.0)
"""The same of an angle, for `heading_near`."""
FAR_M: Final = 1.0
"""What is farther short of its goal looks like this far."""
AROUND_M: Final = 1.0
"""Bounds of what is measured from the box."""


def _box(world: WorldState, scenario: Scenario) -> Floats:
    box = box_in_goal_frame(world, scenario)
    return np.array([max(box.x_m, -FAR_M), mirror_sign(world, scenario) * box.y_m])


def _headings(world: WorldState, scenario: Scenario) -> Floats:
    box = box_in_goal_frame(world, scenario)
    return mirror_sign(world, scenario) * np.array([box.yaw_rad, steering_error_rad(box)])


def _trunk(world: WorldState, scenario: Scenario) -> Floats:
    trunk = station(scenario.box, planar_pose(world.box)).inverse() @ planar_pose(world.trunk)
    sign = mirror_sign(world, scenario)
    return np.array([trunk.x_m, sign * trunk.y_m, sign * trunk.yaw_rad])


def _tip(index: int) -> Callable[[WorldState, Scenario], Floats]:
    """Left (0) or right (1) front foot of the image, from the middle of the rear face."""

    def read(world: WorldState, scenario: Scenario) -> Floats:
        sign = mirror_sign(world, scenario)
        tip = world.tips_m[index if sign > 0.0 else 1 - index]
        x_m, y_m = planar_pose(world.box).inverse().apply([tip[:2]])[0]
        return np.array([x_m + scenario.box.size_m[0] / 2, sign * y_m])

    return read


def _room_limits(scenario: Scenario) -> tuple[Floats, Floats]:
    high = np.full(2, np.hypot(*scenario.room.size_m) + BEYOND_M)
    return -high, high


def _near_limits(scenario: Scenario) -> tuple[Floats, Floats]:
    low, high = _room_limits(scenario)
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
        limits=_room_limits,
    ),
    Entry(
        name="box_near",
        axes="xy",
        size=2,
        read=lambda world, scenario: np.arcsinh(_box(world, scenario) / NEAR_M),
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
        read=lambda world, scenario: np.arcsinh(_headings(world, scenario) / NEAR_RAD),
        meaning=f"asinh of the same over {degrees(NEAR_RAD):g}°",
        unit="1",
        frame="goal",
        limits=_limits(*(float(np.arcsinh(pi / NEAR_RAD)),) * 2),
    ),
    Entry(
        name="trunk",
        axes="xy, yaw",
        size=3,
        read=_trunk,
        meaning="trunk, from where it should stand to push",
        unit="m, rad",
        frame="station",
        limits=_limits(AROUND_M, AROUND_M, pi),
    ),
    *(
        Entry(
            name=f"tip_{side}",
            axes="xy",
            size=2,
            read=_tip(index),
            meaning=f"{side} front foot, from the middle of the box's rear face",
            frame="box",
            limits=_limits(AROUND_M, AROUND_M),
        )
        for index, side in enumerate(("left", "right"))
    ),
)
"""15 elements, in the frames of goal, station and box, mirrored where needed."""
