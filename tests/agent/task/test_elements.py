"""What each number of an observation and of an action is called and means."""

import numpy as np
import pytest

from agent_proc.task.action import n_actions
from agent_proc.task.config import TaskConfig
from agent_proc.task.elements import action_elements, observation_elements
from agent_proc.task.observed import observation_bounds
from tests.agent.tasks import paper, tuned

VARIABLE = tuned()
FIXED = paper(entry="fixed")
DISCRETE = paper(entry="fixed", action_form="discrete")


@pytest.mark.parametrize("task", [VARIABLE, FIXED], ids=["relative", "paper"])
def test_every_observed_number_has_a_name_of_its_own_and_its_bounds(task: TaskConfig) -> None:
    elements = observation_elements(task)

    low, high = observation_bounds(task)
    assert len({element.name for element in elements}) == len(elements) == len(low)
    np.testing.assert_allclose([element.low for element in elements], low, rtol=1e-5)
    np.testing.assert_allclose([element.high for element in elements], high, rtol=1e-5)


def test_an_element_has_the_unit_and_frame_of_its_entry_and_the_name_of_its_axis() -> None:
    by_name = {element.name: element for element in observation_elements(VARIABLE)}

    assert list(by_name)[:2] == ["box.x", "box.y"]
    steering = by_name["heading.steering"]
    assert (steering.unit, steering.frame) == ("rad", "goal")
    assert [element.name for element in observation_elements(FIXED)][:3] == ["body.x", "body.y", "body.z"]


@pytest.mark.parametrize("task", [VARIABLE, FIXED, DISCRETE], ids=["variable", "fixed", "discrete"])
def test_every_number_of_an_action_is_named(task: TaskConfig) -> None:
    names = [element.name for element in action_elements(task)]

    assert len(names) == n_actions(task)
    assert names == ["w1", "w2", "leg", "depth"][: len(names)]


def test_choices_are_counted_from_zero_and_numbers_lie_about_it() -> None:
    assert [(e.low, e.high) for e in action_elements(DISCRETE)] == [(0.0, 7.0), (0.0, 7.0), (0.0, 1.0)]
    assert [(e.low, e.high) for e in action_elements(VARIABLE)] == [(-1.0, 1.0)] * 4


def test_the_mirrored_leg_and_the_limited_depth_are_explained() -> None:
    *_, leg, depth = action_elements(VARIABLE)

    assert "mirror image" in leg.meaning
    assert "mirror image" not in action_elements(FIXED)[2].meaning
    assert "up to its goal, at most 0.1 m" in depth.meaning
    assert "up to its goal" not in action_elements(tuned(limit_depth=False))[3].meaning


def test_what_is_done_to_a_term_is_said_with_its_meaning() -> None:
    scaled = tuned(observation={"box": {"scale": 0.5}, "yaw": {}}, scaling="bounds")
    meanings = [element.meaning for element in observation_elements(scaled)]

    assert meanings[0].endswith(", times 0.5, mapped from its bounds to [-1, 1]")
    assert meanings[2] == "heading of the box, mapped from its bounds to [-1, 1]"
    assert [(element.low, element.high) for element in observation_elements(scaled)] == [(-1.0, 1.0)] * 3


def test_an_element_is_named_after_its_term_in_the_task() -> None:
    task = tuned(observation={"angle": {"term": "yaw"}})

    assert [element.name for element in observation_elements(task)] == ["angle.yaw"]
