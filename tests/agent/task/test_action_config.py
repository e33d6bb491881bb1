"""The record of the actions: what cannot be carried out is refused."""

import pytest

from agent_proc.task.action_config import ActionConfig
from legpush.errors import ConfigError


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"action_form": "discrete"}, "entry `fixed`"),
        ({"fixed_depth_m": 0.0}, "fixed_depth_m"),
        ({"fixed_depth_m": 0.3}, "fixed_depth_m"),
        ({"least_depth_m": 0.06, "max_depth_m": 0.05}, "least_depth_m <= max_depth_m"),
    ],
)
def test_actions_that_cannot_be_carried_out_are_refused_by_name(fields: dict[str, object], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        ActionConfig(**fields)  # type: ignore[arg-type]


def test_the_published_grid_needs_a_fixed_depth() -> None:
    assert ActionConfig(entry="fixed", action_form="discrete").fixed_depth_m == 0.05
