"""Whether an obstacle stands in the way of the box, or of the robot behind it."""

import pytest

from agent_proc.pushing.obstacles import is_in_push
from agent_proc.pushing.stage import Stage
from legpush.geometry import Pose2
from legpush.scene.scenario import Rectangle
from tests.agent.fake_world import make_scenario

CRATE = Rectangle(x_min_m=4.0, x_max_m=4.5, y_min_m=1.0, y_max_m=2.0)
SCENARIO = make_scenario()


@pytest.mark.parametrize(
    ("y_m", "from_m", "expected"),
    [
        (2.33, 0.0, False),
        (2.31, 0.0, True),
        (2.26, 3.8, True),  # the box is past the crate, the robot behind it is not
        (2.26, 4.5, False),
    ],
)
def test_a_push_is_blocked_by_what_is_nearer_than_the_margin_to_box_or_robot(
    y_m: float, from_m: float, expected: bool
) -> None:
    path = Stage("rear", tuple(Pose2(x_m=1.5 + k / 10, y_m=y_m, yaw_rad=0.0) for k in range(51)), 0.1)

    assert is_in_push(CRATE, SCENARIO, path, from_m) == expected
