"""The rules by which a policy has nothing left to do, each at both sides of its border."""

from math import radians

import pytest

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.task.action_config import ActionConfig
from agent_proc.task.ending.arrivals import NoPushHelps, PastGoal, Release, Tolerance
from agent_proc.task.term import ArrivalTerm
from legpush.geometry import Pose2
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()
"""The goal is at (7, 3), heading along x; its tolerances are 0.03 m and 3 degrees."""
FIXED = ActionConfig(entry="fixed")


def at(x_m: float, y_m: float = 3.0, yaw_deg: float = 0.0) -> PushView:
    trunk = Pose2(x_m=x_m - 0.618, y_m=y_m, yaw_rad=0.0)
    return push_view(make_state(trunk, Pose2(x_m=x_m, y_m=y_m, yaw_rad=radians(yaw_deg))), SCENARIO)


@pytest.mark.parametrize(
    ("term", "view", "arrived"),
    [
        (Tolerance(), at(6.98, 3.02, 2.9), True),
        (Tolerance(), at(6.98, 3.02, 3.1), False),
        (Tolerance(), at(7.031), False),
        (PastGoal(), at(6.999), False),
        (PastGoal(), at(7.0, 4.0, 90.0), True),
        (PastGoal(beyond_m=0.1), at(7.09), False),
        (PastGoal(beyond_m=0.1), at(7.11), True),
        (NoPushHelps(), at(6.98), False),
        (NoPushHelps(), at(6.99), True),
        (Release(), at(6.89), False),
        (Release(), at(6.91, 3.04), True),  # 9.8 cm off
        (Release(), at(6.91, 3.05), False),  # 10.3 cm off
        (Release(), at(6.951, 3.9), True),  # Near in x alone, and 90 cm aside.
        (Release(), at(6.94, 3.9), False),
        (Release(), at(6.93, 3.0, 20.0), True),  # One corner is, the other one is not.
        (Release(corner_m=0.2), at(6.85), True),
        (Release(x_m=0.2), at(6.85, 3.9), True),
    ],
)
def test_a_rule_holds_at_its_side_of_the_border(term: ArrivalTerm, view: PushView, arrived: bool) -> None:
    assert term.arrived(view, FIXED) == arrived
