"""The least number of pushes that could bring a box to its goal, whatever chooses them."""

from math import cos, hypot, inf, radians, sin
from typing import Final

from agent_proc.pushing.follower import TUBE_M
from legpush.bounds import MAX_DEPTH_M
from legpush.geometry import Pose2, distance_m
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.reference import least_radius_m
from legpush.scene.scenario import Scenario

PEAK_SPEED_SHARE: Final = 2.5
"""Greatest speed of a pushed box, as a multiple of the mean speed of a foot that goes from its place on the floor
beyond the face. Boxes of 0.01 to 1 kg on a floor with a friction of 0.05 reached 2.4, over all depths and curves."""
GRAVITY_M_S2: Final = 9.81


def most_travel_m(scenario: Scenario) -> float:
    """The farthest that one push can move the box: as deep as it may be, then sliding until friction stops it.

    It is infinite on a slope on which the box slides by itself.
    """
    motion, slope_rad = scenario.robot.pushing, radians(scenario.room.slope_deg)
    holds = scenario.box.friction * cos(slope_rad) - sin(slope_rad)
    if holds <= 0.0:
        return inf
    speed_m_s = PEAK_SPEED_SHARE * (motion.gap_m + MAX_DEPTH_M) / (motion.push_ticks * CONTROL_PERIOD_S)
    return MAX_DEPTH_M + speed_m_s**2 / (2.0 * GRAVITY_M_S2 * holds)


def least_distance_m(scenario: Scenario, box: Pose2, reference_m: float | None) -> float:
    """The least distance that a box has to move from a pose until the mission may succeed.

    Without a reference, it is the straight line to where the tolerance of the goal begins: another path may be shorter
    than the planned one. A reference of `reference_m` is followed to its end, on the inner side of its curves at best.
    """
    free_m = scenario.goal.position_tolerance_m + hypot(
        scenario.randomization.box_xy_m, scenario.randomization.box_xy_m
    )
    straight_m = distance_m(box, scenario.goal.pose.pose()) - free_m
    if scenario.reference is None or reference_m is None:
        return max(straight_m, 0.0)
    inner_share = max(1.0 - TUBE_M / least_radius_m(scenario.reference), 0.0)
    return max(straight_m, inner_share * (reference_m - free_m), 0.0)
