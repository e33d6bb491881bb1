"""The record of a task: what cannot be learned is refused, what can survives being saved."""

import msgspec
import pytest
from msgspec.structs import replace

from agent_proc.task.config import TaskConfig
from agent_proc.task.domain import Domain
from agent_proc.task.file import load_task, task_names
from legpush.errors import ConfigError
from tests.agent.tasks import tuned


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"max_steps": 0}, "max_steps"),
        ({"action_form": "discrete"}, "entry `fixed`"),
        ({"observation": {}}, "at `observation`: expected at least one term"),
        ({"reward": {}}, "at `reward`: expected at least one term"),
        ({"reward": {"fall": {"weigth": 1.0}}}, r"at `reward.fall.weigth`: unknown field \(did you mean `weight`\?\)"),
        ({"ending": {"fall": {}}}, r"at `ending.fall`: .* ArrivalTerm or AbortTerm, got 'fall'"),
        ({"observation": {"body": {}}}, "terms with a mirror image in a mirrored task, got body"),
    ],
)
def test_a_task_that_cannot_be_carried_out_is_refused_by_name(fields: dict[str, object], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        tuned(**fields)


@pytest.mark.parametrize("name", task_names())
def test_a_task_is_the_same_after_it_was_saved_and_loaded(name: str) -> None:
    task = replace(load_task(name), domain=Domain(mass_kg=(0.1, 0.9)))
    again = msgspec.json.decode(msgspec.json.encode(task), type=TaskConfig)

    assert again == task
    assert list(again.reward_terms) == list(task.reward_terms)
    assert again.observation_terms == task.observation_terms


def test_a_task_needs_no_rule_of_its_own_to_end() -> None:
    task = tuned(ending={})

    assert (task.arrival_terms, task.abort_terms) == ((), ())
