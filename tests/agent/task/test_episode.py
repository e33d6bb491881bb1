"""What a step earns, when an episode ends, and how."""

from math import radians

import pytest

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import earned, episode_ending, has_arrived
from agent_proc.task.term import PushStep
from legpush.geometry import Pose2
from legpush.scene.station import station
from tests.agent.fake_world import make_state, scenario_at_station
from tests.agent.tasks import paper, tuned
from tests.robots import ROBOT

SCENARIO = scenario_at_station()
"""The goal is at (7, 3), heading along x; its tolerances are 0.03 m and 3 degrees."""
TUNED = tuned(scenario=SCENARIO, max_steps=10)
ASTRAY = TUNED.ending["astray"]["more"]
PAPER = paper(entry="fixed", scenario=SCENARIO, max_steps=10)


def at(x_m: float, y_m: float = 3.0, yaw_deg: float = 0.0, *, fallen: bool = False, behind_m: float = 0.0) -> PushView:
    """The robot at its station, or this much farther behind the box."""
    box = Pose2(x_m=x_m, y_m=y_m, yaw_rad=radians(yaw_deg))
    trunk = station(ROBOT, SCENARIO.box, box) @ Pose2(x_m=-behind_m, y_m=0.0, yaw_rad=0.0)
    return push_view(make_state(trunk, box, fallen=fallen), SCENARIO)


FIRST = at(6.0)


@pytest.mark.parametrize("task", [TUNED, PAPER], ids=["tuned", "paper"])
def test_an_episode_goes_on_between_start_and_goal(task: TaskConfig) -> None:
    assert not has_arrived(task, at(6.5))
    assert episode_ending(task, FIRST, at(6.5), 9) is None


@pytest.mark.parametrize("task", [TUNED, PAPER], ids=["tuned", "paper"])
def test_a_box_at_its_goal_is_a_success(task: TaskConfig) -> None:
    assert has_arrived(task, at(7.0, 3.01, 1.0))
    assert episode_ending(task, FIRST, at(7.0, 3.01, 1.0), 9) == "success"


def test_the_published_episode_ends_within_the_tolerances_and_the_tuned_one_where_no_push_helps() -> None:
    within, beyond = at(6.98), at(7.2)

    assert (has_arrived(PAPER, within), has_arrived(TUNED, within)) == (True, False)
    assert (has_arrived(PAPER, beyond), has_arrived(TUNED, beyond)) == (False, True)
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


def test_the_rule_is_a_setting_of_its_own_whatever_is_paid() -> None:
    paid_by_text = paper(scenario=SCENARIO, ending=TUNED.ending)

    assert episode_ending(paid_by_text, FIRST, at(7.2), 9) == "missed"
    assert episode_ending(tuned(scenario=SCENARIO, ending=PAPER.ending), FIRST, at(7.2), 9) is None


def test_a_reward_has_the_names_and_weights_of_its_task_and_no_zero_has_a_sign() -> None:
    step = PushStep(first=FIRST, before=FIRST, after=at(7.0), ending=None)
    task = tuned(reward={"a": {"term": "cycle", "weight": -3.0}, "fall": {"weight": -5.0}})

    assert earned(task, step) == {"a": -3.0, "fall": 0.0}
    assert str(earned(task, step)["fall"]) == "0.0"
