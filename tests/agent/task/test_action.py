"""What an action means: bounds, legs, depth, and the mirror."""

from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis.extra.numpy import arrays
from hypothesis.strategies import floats
from numpy.typing import NDArray

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.push_model.estimate import FeltBox
from agent_proc.push_model.model import PushModel
from agent_proc.task.action import deepest_push_m, no_push_helps, to_push
from agent_proc.task.config import TaskConfig
from legpush.errors import ConfigError
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from tests.agent.fake_world import make_scenario, make_state
from tests.agent.tasks import paper, tuned

SCENARIO = make_scenario()
"""The goal is at x = 7, y = 3."""
FIXED = tuned(entry="fixed")
VARIABLE = tuned()
GRID = paper(entry="fixed", action_form="discrete")


def box_at(x_m: float, y_m: float = 3.0) -> PushView:
    box = Pose2(x_m=x_m, y_m=y_m, yaw_rad=0.0)
    return push_view(make_state(Pose2(x_m=x_m - 0.618, y_m=y_m, yaw_rad=0.0), box), SCENARIO)


FAR = box_at(6.0)


def push(task: TaskConfig, action: list[float], view: PushView = FAR) -> Push:
    kind = np.int64 if task.action_form == "discrete" else np.float32
    return to_push(np.array(action, dtype=kind), task, view)


def test_the_corners_of_the_space_are_the_extremes_of_the_push() -> None:
    assert push(FIXED, [-1.0, 1.0, -1.0]) == Push(w1=0.0, w2=1.0, leg="FL", depth_m=FIXED.fixed_depth_m)
    assert push(VARIABLE, [1.0, -1.0, 1.0, -1.0]) == Push(w1=1.0, w2=0.0, leg="FR", depth_m=VARIABLE.least_depth_m)
    assert push(VARIABLE, [1.0, -1.0, 1.0, 1.0]).depth_m == pytest.approx(VARIABLE.max_depth_m)


def test_the_published_grid_runs_from_a_tenth_to_eight_tenths() -> None:
    assert push(GRID, [0, 7, 0]) == Push(w1=0.1, w2=0.8, leg="FL", depth_m=GRID.fixed_depth_m)
    assert push(GRID, [2, 4, 1]) == Push(w1=0.3, w2=0.5, leg="FR", depth_m=GRID.fixed_depth_m)


@pytest.mark.parametrize(
    ("action", "got"),
    [
        (np.array([0.0, 0.0, 0.0, nan]), "dtype float64, shape (4,)"),
        (np.array([0.0, 0.0, 0.0, -inf], dtype=np.float32), "dtype float32, shape (4,)"),
        (np.zeros(3, dtype=np.float32), "dtype float32, shape (3,)"),
        (np.zeros((1, 4), dtype=np.float32), "dtype float32, shape (1, 4)"),
        (np.array(["0"] * 4), "dtype <U1, shape (4,)"),
        (np.zeros(4, dtype=complex), "dtype complex128, shape (4,)"),
        (np.zeros(4, dtype=bool), "dtype bool, shape (4,)"),
    ],
)
def test_an_action_outside_its_space_is_refused_with_its_dtype_and_shape(action: NDArray[Any], got: str) -> None:
    with pytest.raises(ConfigError, match=r"Expected an action of 4 finite numbers") as refused:
        to_push(action, VARIABLE, FAR)
    assert got in str(refused.value)


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, np.int8, np.int64])
def test_numbers_of_any_type_are_converted(dtype: type) -> None:
    ones = np.array([1, -1, 1, -1])
    assert to_push(ones.astype(dtype), VARIABLE, FAR) == push(VARIABLE, [1.0, -1.0, 1.0, -1.0])


@given(arrays(np.float64, 4, elements=floats(-1e6, 1e6)))
def test_numbers_out_of_range_are_clipped(action: NDArray[np.float64]) -> None:
    before = action.copy()
    assert to_push(action, VARIABLE, FAR) == push(VARIABLE, np.clip(action, -1.0, 1.0).tolist())
    assert (action == before).all()


@pytest.mark.parametrize("action", [[8, 0, 0], [0, 0, 2], [0, -1, 0], [0, 0]])
def test_a_choice_that_is_not_on_the_grid_is_refused(action: list[float]) -> None:
    with pytest.raises(ConfigError, match=r"Expected an action of 3 integers below \(8, 8, 2\), got array"):
        push(GRID, action)


def test_numbers_are_no_choices() -> None:
    with pytest.raises(ConfigError, match=r"Expected an action of 3 integers .* dtype float32, shape \(3,\)"):
        to_push(np.zeros(3, dtype=np.float32), GRID, FAR)


def test_the_leg_is_that_of_the_mirror_image_where_the_box_is_right_of_the_line() -> None:
    left, right = box_at(6.0, 3.05), box_at(6.0, 2.95)

    assert [push(FIXED, [0.0, 0.0, leg], left).leg for leg in (-1.0, 1.0)] == ["FL", "FR"]
    assert [push(FIXED, [0.0, 0.0, leg], right).leg for leg in (-1.0, 1.0)] == ["FR", "FL"]


def test_the_leg_is_as_it_says_where_nothing_is_mirrored() -> None:
    right = box_at(6.0, 2.95)

    assert [push(GRID, [0, 0, leg], right).leg for leg in (0, 1)] == ["FL", "FR"]


@pytest.mark.parametrize("short_m", [0.02, 0.03, 0.05, 0.07])
def test_the_deepest_push_brings_the_box_up_to_its_goal_and_no_farther(short_m: float) -> None:
    depth_m = push(VARIABLE, [0.0, 0.0, 0.0, 1.0], box_at(7.0 - short_m)).depth_m

    model = PushModel()
    assert np.interp(depth_m, model.depth_m, model.forward_m) == pytest.approx(short_m)


def test_the_depth_stays_between_its_limits_wherever_the_box_is() -> None:
    assert deepest_push_m(VARIABLE, box_at(5.0)) == VARIABLE.max_depth_m
    assert deepest_push_m(VARIABLE, box_at(7.1)) == VARIABLE.least_depth_m
    assert deepest_push_m(tuned(limit_depth=False), box_at(7.1)) == VARIABLE.max_depth_m


def test_pushing_on_is_no_help_from_half_a_shallowest_push_before_the_goal() -> None:
    travel_m = 0.036  # of a push of 0.05 m
    assert not no_push_helps(FIXED, box_at(7.0 - 0.51 * travel_m))
    assert no_push_helps(FIXED, box_at(7.0 - 0.49 * travel_m))
    assert not no_push_helps(VARIABLE, box_at(7.0 - 0.49 * travel_m))
    assert not no_push_helps(VARIABLE, box_at(7.0 - 0.0010))  # 1.7 mm by a push of 5 mm
    assert no_push_helps(VARIABLE, box_at(7.0 - 0.0008))


@pytest.mark.parametrize("lost_m", [0.0, 0.004, 0.03])
def test_a_box_that_loses_depth_is_pushed_deeper_by_as_much(lost_m: float) -> None:
    view = replace(box_at(6.98), felt=FeltBox(lost_depth_m=lost_m))
    for unit in (-1.0, 0.3, 1.0):
        usual = push(VARIABLE, [0.0, 0.0, 0.0, unit], box_at(6.98)).depth_m
        assert push(VARIABLE, [0.0, 0.0, 0.0, unit], view).depth_m == pytest.approx(usual + lost_m)
    assert deepest_push_m(VARIABLE, replace(box_at(5.0), felt=FeltBox(lost_depth_m=lost_m))) == VARIABLE.max_depth_m
    assert push(FIXED, [0.0, 0.0, 0.0], view).depth_m == FIXED.fixed_depth_m


def test_the_least_useful_push_is_that_of_this_box() -> None:
    """A fixed depth moves a box less that loses some of it; a variable one is chosen deeper."""
    short = box_at(7.0 - 0.0012)
    for lost_m, helps in ((0.0, True), (0.02, True)):
        assert no_push_helps(VARIABLE, replace(short, felt=FeltBox(lost_depth_m=lost_m))) != helps
    near = box_at(7.0 - 0.012)
    assert no_push_helps(FIXED, near)
    assert not no_push_helps(FIXED, replace(near, felt=FeltBox(lost_depth_m=0.03)))
