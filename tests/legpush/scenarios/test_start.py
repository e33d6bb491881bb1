"""The start of an episode: offsets of a seed."""

from math import degrees

import numpy as np
from msgspec.structs import replace

from legpush.realism.settings import Randomization
from legpush.scenarios.file import load_scenario
from legpush.scenarios.start import drawn_poses


def test_the_seed_moves_robot_and_box_within_the_half_widths() -> None:
    spread = Randomization(start_xy_m=0.05, start_yaw_deg=5.0, box_xy_m=0.02, box_yaw_deg=3.0)
    scenario = replace(load_scenario("push"), randomization=spread)
    nominal = (scenario.start.pose(), scenario.box.pose.pose())
    offsets = []
    for seed in range(200):
        for drawn, base in zip(drawn_poses(scenario, seed), nominal, strict=True):
            offsets.append([drawn.x_m - base.x_m, drawn.y_m - base.y_m, degrees(drawn.yaw_rad - base.yaw_rad)])
    largest = np.abs(np.array(offsets).reshape(200, 6)).max(axis=0)
    limits = np.array([0.05, 0.05, 5.0, 0.02, 0.02, 3.0])
    assert (largest <= limits).all()
    assert (largest > 0.9 * limits).all()
    assert drawn_poses(scenario, 5) == drawn_poses(scenario, 5)
