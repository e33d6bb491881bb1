"""The start of an episode: poses of robot and box, with the offsets of a seed."""

from math import radians

import numpy as np

from legpush.geometry import Pose2
from legpush.scene.scenario import Scenario


def drawn_poses(scenario: Scenario, seed: int) -> tuple[Pose2, Pose2]:
    """Return the poses of robot and box at the start: the nominal ones plus uniform offsets drawn from the seed."""
    spread = scenario.randomization
    half_widths = np.array(
        [
            *[spread.start_xy_m] * 2,
            radians(spread.start_yaw_deg),
            *[spread.box_xy_m] * 2,
            radians(spread.box_yaw_deg),
        ]
    )
    offsets = np.random.default_rng(seed).uniform(-half_widths, half_widths).tolist()
    nominal = (scenario.start.pose(), scenario.box.pose.pose())
    start, box = (
        Pose2(x_m=pose.x_m + dx, y_m=pose.y_m + dy, yaw_rad=pose.yaw_rad + turn)
        for pose, (dx, dy, turn) in zip(nominal, (offsets[:3], offsets[3:]), strict=True)
    )
    return start, box
