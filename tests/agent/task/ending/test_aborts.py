"""The rules by which an episode is given up."""

from math import radians

import pytest

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.task.ending.aborts import Astray
from legpush.geometry import Pose2
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()


def turned(yaw_deg: float) -> PushView:
    box = Pose2(x_m=6.5, y_m=3.0, yaw_rad=radians(yaw_deg))
    return push_view(make_state(Pose2(x_m=5.9, y_m=3.0, yaw_rad=0.0), box), SCENARIO)


@pytest.mark.parametrize("more", [2.0, 5.0])
def test_an_episode_is_given_up_where_its_errors_have_grown_by_as_many_tolerances(more: float) -> None:
    first, less, much = turned(3.0), turned(3.0 + 3.0 * (more - 0.1)), turned(3.0 + 3.0 * (more + 0.1))

    assert not Astray(more=more).aborts(first, less)
    assert Astray(more=more).aborts(first, much)
