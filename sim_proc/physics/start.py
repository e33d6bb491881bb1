"""Where robot and box are at the start of an episode."""

from math import cos, sin

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.scenario import Scenario
from sim_proc.kinematics.leg import LegKinematics


def standing_qpos(scenario: Scenario, trunk: Pose2, box: Pose2) -> Floats:
    """`qpos` (26,) of the robot in its stance at `trunk`, and of the box at `box`."""
    robot = scenario.robot
    return np.concatenate(
        [
            _pose(trunk, robot.stance.height_m),
            LegKinematics(robot).standing_joints_rad().ravel(),
            _pose(box, scenario.box.size_m[2] / 2),
        ]
    )


def _pose(place: Pose2, height_m: float) -> list[float]:
    """Position and quaternion of something level at a height."""
    return [place.x_m, place.y_m, height_m, cos(place.yaw_rad / 2), 0.0, 0.0, sin(place.yaw_rad / 2)]
