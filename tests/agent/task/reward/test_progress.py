"""Progress adds up, the end counts, and falling never pays with the weights of the task `tuned`."""

from itertools import pairwise
from math import degrees, radians

import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent_proc.frames.push_view import LOOK_AHEAD_M, PushView, push_view
from agent_proc.task.episode import earned
from agent_proc.task.reward.progress import errors_in_tolerances, steering_in_tolerances
from agent_proc.task.term import EpisodeEnding, PushStep
from legpush.geometry import Pose2
from tests.agent.fake_world import make_scenario, make_state
from tests.agent.tasks import tuned

SCENARIO = make_scenario()
TRUNK = Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0)
TASK = tuned()
MAX_STEPS = TASK.max_steps
POSITION_WEIGHT, STEERING_WEIGHT = (TASK.reward[name]["weight"] for name in ("position", "steering"))
CYCLE_COST, FALL_PENALTY = (-TASK.reward[name]["weight"] for name in ("cycle", "fall"))
ASTRAY = TASK.ending["astray"]["more"]

boxes = st.builds(Pose2, x_m=st.floats(5.9, 7.1), y_m=st.floats(2.8, 3.2), yaw_rad=st.floats(-0.5, 0.5))


def view_of(box: Pose2, *, fallen: bool = False) -> PushView:
    return push_view(make_state(TRUNK, box, fallen=fallen), SCENARIO)


def at(x_m: float, y_m: float = 3.0, yaw_deg: float = 0.0) -> PushView:
    return view_of(Pose2(x_m=x_m, y_m=y_m, yaw_rad=radians(yaw_deg)))


def value(first: PushView, views: list[PushView], *, arrived: bool) -> float:
    """Return of an episode through these states."""
    steps = list(pairwise([first, *views]))
    total = 0.0
    for before, after in steps:
        ending: EpisodeEnding | None = "fell" if after.fallen else None
        if arrived and after is views[-1]:
            ending = "success" if after.error.within(after.goal) else "missed"
        total += sum(earned(TASK, PushStep(first=first, before=before, after=after, ending=ending)).values())
    return total


@given(path=st.lists(boxes, min_size=2, max_size=8))
def test_progress_depends_on_the_first_and_the_last_state_only(path: list[Pose2]) -> None:
    views = [view_of(box) for box in path]
    position = [errors_in_tolerances(view)[0] for view in (views[0], views[-1])]
    steering = [steering_in_tolerances(view) for view in (views[0], views[-1])]
    progress = POSITION_WEIGHT * (position[0] - position[1]) + STEERING_WEIGHT * (steering[0] - steering[1])

    total = value(views[0], views[1:], arrived=False)

    assert total == pytest.approx(progress - CYCLE_COST * (len(views) - 1))


@given(path=st.lists(boxes, min_size=1, max_size=8), fall_at=boxes)
def test_falling_pays_less_than_the_worst_that_can_be_done_standing(path: list[Pose2], fall_at: Pose2) -> None:
    first = at(6.0)
    goal = SCENARIO.goal
    steering_by_position = degrees(goal.position_tolerance_m / LOOK_AHEAD_M) / goal.angle_tolerance_deg
    each = POSITION_WEIGHT + STEERING_WEIGHT * max(1.0, steering_by_position)
    worst_standing = -(ASTRAY + 10.0) * each - CYCLE_COST * MAX_STEPS

    fallen = value(first, [*(view_of(box) for box in path), view_of(fall_at, fallen=True)], arrived=False)

    assert fallen < worst_standing


def test_a_fall_takes_back_all_progress() -> None:
    first = at(6.0, 3.1, 5.0)
    fallen = view_of(Pose2(x_m=6.8, y_m=3.0, yaw_rad=0.0), fallen=True)

    assert value(first, [at(6.4), at(6.7), fallen], arrived=False) == pytest.approx(-FALL_PENALTY - 3 * CYCLE_COST)


def test_the_end_pays_more_the_nearer_it_is_and_success_most() -> None:
    first = at(6.0)
    ends = [at(7.0), at(6.99), at(6.99, 3.01), at(6.975, 3.01, 2.5), at(6.96, 3.01, 2.5), at(7.2, 3.1, 8.0)]

    values = [value(first, [end], arrived=True) for end in ends]

    assert values == sorted(values, reverse=True)
    assert values[3] - values[4] > 2.5


def test_a_way_there_and_back_earns_nothing_but_costs_its_cycles() -> None:
    first = at(6.0)

    assert value(first, [at(6.5), first], arrived=False) == pytest.approx(-2 * CYCLE_COST)
