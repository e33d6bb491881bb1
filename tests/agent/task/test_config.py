"""The record of a task: what cannot be learned is refused, what can survives being saved."""

import msgspec
import pytest

from agent_proc.task.config import Domain, TaskConfig
from legpush.errors import ConfigError


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"action_form": "discrete"}, "entry `fixed`"),
        ({"fixed_depth_m": 0.0}, "fixed_depth_m"),
        ({"fixed_depth_m": 0.3}, "fixed_depth_m"),
        ({"least_depth_m": 0.06, "max_depth_m": 0.05}, "least_depth_m <= max_depth_m"),
        ({"max_steps": 0}, "max_steps"),
    ],
)
def test_a_task_that_cannot_be_carried_out_is_refused_by_name(fields: dict[str, object], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        TaskConfig(**fields)  # type: ignore[arg-type]


@pytest.mark.parametrize("interval", [(0.0, 1.0), (2.0, 1.0), (-1.0, 1.0)])
def test_a_domain_holds_positive_intervals_only(interval: tuple[float, float]) -> None:
    with pytest.raises(ConfigError, match="friction"):
        Domain(friction=interval)


def test_a_task_is_the_same_after_it_was_saved_and_loaded() -> None:
    task = TaskConfig(entry="fixed", action_form="discrete", domain=Domain(mass_kg=(0.1, 0.9)))

    assert msgspec.json.decode(msgspec.json.encode(task), type=TaskConfig) == task
