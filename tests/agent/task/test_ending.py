"""When an episode ends, and how."""

from math import radians

import pytest

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.task.config import TaskConfig
from agent_proc.task.ending import ASTRAY, episode_ending, is_done
from legpush.geometry import Pose2
from legpush.scene.station import station
from tests.agent.fake_world import make_state, scenario_at_station
from tests.robots import ROBOT

SCENARIO = scenario_at_station()
"""The goal is at (7, 3), heading along x; its tolerances are 0.03 m and 3 degrees."""
TUNED = TaskConfig(scenario=SCENARIO, max_steps=10)
PAPER = TaskConfig(entry="fixed", observation="paper", reward="paper", scenario=SCENARIO, max_steps=10)


def at(x_m: float, y_m: float = 3.0, yaw_deg: float = 0.0, *, fallen: bool = False, behind_m: float = 0.0) -> PushView:
    """The robot at its station, or this much farther behind the box."""
    box = Pose2(x_m=x_m, y_m=y_m, yaw_rad=radians(yaw_deg))
    trunk = station(ROBOT, SCENARIO.box, box) @ Pose2(x_m=-behind_m, y_m=0.0, yaw_rad=0.0)
    return push_view(make_state(trunk, box, fallen=fallen), SCENARIO)


FIRST = at(6.0)


@pytest.mark.parametrize("task", [TUNED, PAPER], ids=["tuned", "paper"])
def test_an_episode_goes_on_between_start_and_goal(task: TaskConfig) -> None:
    assert not is_done(task, at(6.5))
    assert episode_ending(task, FIRST, at(6.5), 9) is None


@pytest.mark.parametrize("task", [TUNED, PAPER], ids=["tuned", "paper"])
def test_a_box_at_its_goal_is_a_success(task: TaskConfig) -> None:
    assert is_done(task, at(7.0, 3.01, 1.0))
    assert episode_ending(task, FIRST, at(7.0, 3.01, 1.0), 9) == "success"


def test_the_published_episode_ends_within_the_tolerances_and_the_tuned_one_where_no_push_helps() -> None:
    within, beyond = at(6.98), at(7.2)

    assert (is_done(PAPER, within), is_done(TUNED, within)) == (True, False)
    assert (is_done(PAPER, beyond), is_done(TUNED, beyond)) == (False, True)
    assert episode_ending(TUNED, FIRST, beyond, 9) == "missed"


def test_a_fall_ends_an_episode_even_at_the_goal() -> None:
    assert episode_ending(TUNED, FIRST, at(7.0, fallen=True), 9) == "fell"


def test_a_box_that_has_slid_away_from_the_robot_is_astray() -> None:
    assert episode_ending(PAPER, FIRST, at(6.5, behind_m=0.9 * ROBOT.pushing.at_station_m), 1) is None
    assert episode_ending(PAPER, FIRST, at(6.5, behind_m=1.1 * ROBOT.pushing.at_station_m), 1) == "astray"


def test_errors_that_outgrow_those_of_the_start_end_a_tuned_episode_only() -> None:
    less, more = (at(6.0, yaw_deg=3.0 * (ASTRAY + d)) for d in (-0.1, 0.1))

    assert episode_ending(TUNED, FIRST, less, 1) is None
    assert episode_ending(TUNED, FIRST, more, 1) == "astray"
    assert episode_ending(PAPER, FIRST, more, 1) is None


def test_an_episode_is_truncated_after_the_steps_of_its_task() -> None:
    assert [episode_ending(TUNED, FIRST, at(6.5), n) for n in (9, 10)] == [None, "max_steps"]
