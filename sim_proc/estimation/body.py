"""The robot as the estimator takes it to be: one array of numbers for compiled functions."""

import numpy as np

from legpush.arrays import Floats
from legpush.scene.robot import RobotSpec
from sim_proc.kinematics.leg import SIDE, LegKinematics


def body_numbers(robot: RobotSpec, gravity_m_s2: Floats, trunk: Floats, links: Floats) -> Floats:
    """Return the numbers in the order of `layout.HIPS` and so on.

    `gravity_m_s2` (3,) is in the frame of the floor. `trunk` (4,) and `links` (12, 4) have the mass of the trunk and of
    hip, upper and lower leg of each leg, and their masses times centres in their own frames.
    """
    legs = robot.legs
    return np.concatenate(
        [
            LegKinematics(robot).hips_b.ravel(),
            legs.hip_offset_m * SIDE,
            [legs.upper_length_m, legs.lower_length_m, legs.foot_radius_m],
            gravity_m_s2,
            [standing_height_m(robot), trunk[0] + links[:, 0].sum()],
            trunk[1:],
            links.ravel(),
        ]
    )


def standing_height_m(robot: RobotSpec) -> float:
    """Return the height of the centre of a foot that stands on the floor and is pressed into it by half of what is
    commanded."""
    return robot.legs.foot_radius_m - robot.gait.press_m / 2
