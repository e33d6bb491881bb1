"""A stage of the box's path: where on it a pose is, and where it is straight."""

from math import degrees, pi, radians

import pytest

from agent_proc.pushing.stage import Stage
from legpush.geometry import Pose2
from tests.agent.pushing.paths import AXLE_M, BEHIND, quarter


def test_a_place_on_a_path_is_found_from_the_box_beside_it() -> None:
    path = Stage("rear", quarter(0.8, 0.5), AXLE_M)
    beside = path.pose(0.9) @ BEHIND @ Pose2(x_m=0.0, y_m=0.03, yaw_rad=radians(4.0))
    box = beside @ Pose2(x_m=AXLE_M, y_m=0.0, yaw_rad=0.0)

    deviation = path.deviation(box, 0.5, 1.2)

    assert path.length_m == pytest.approx(0.8 * pi / 2 + 0.5, rel=1e-3)
    assert deviation.distance_m == pytest.approx(0.9, abs=0.005)
    assert deviation.left_m == pytest.approx(0.03, abs=1e-3)
    assert degrees(deviation.heading_rad) == pytest.approx(4.0, abs=0.3)
    assert path.straight_until_m(0.5) == 0.5
    assert path.straight_until_m(1.4) == path.length_m
    assert path.pose(path.length_m) == path.end
