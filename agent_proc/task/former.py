"""Tasks of earlier versions of legpush, which named observation and reward with one word each.

What they meant is written down here, and does not follow later changes of the built-in tasks.
"""

from collections.abc import Mapping
from typing import Any, Final

from agent_proc.task.terms import PARTS, Tables
from legpush.errors import ConfigError

OBSERVATIONS: Final[dict[str, Tables]] = {
    "paper": {
        "body": {},
        "box_corner_1": {"term": "box_corner", "corner": 1},
        "box_corner_2": {"term": "box_corner", "corner": 2},
        **{f"tip_{leg}": {"term": "tip", "leg": leg} for leg in ("FL", "FR", "RL", "RR")},
        "goal_corner_1": {"term": "goal_corner", "corner": 1},
        "goal_corner_2": {"term": "goal_corner", "corner": 2},
    },
    "relative": {
        "box": {"far_m": 1.0},
        "box_near": {"far_m": 1.0, "near_m": 0.05},
        "heading": {},
        "heading_near": {"near_deg": 1.0},
    },
}
"""Terms by the word for the observation; the one of `relative` was mirrored, action and all."""
REWARDS: Final[dict[str, Tables]] = {
    "paper": {
        "position": {"term": "corner_distance", "weight": -10.0},
        "angle": {"term": "angle_error", "weight": -2.0},
        "fall": {"weight": -10.0},
    },
    "tuned": {
        "position": {"term": "position_progress", "weight": 0.1},
        "steering": {"term": "steering_progress", "weight": 0.3},
        "cycle": {"weight": -0.02},
        "success": {"weight": 3.0},
        "precision": {"weight": 6.0, "position_decay": 2.0, "angle_decay": 3.0},
        "fall": {"weight": -20.0},
    },
}
ENDINGS: Final[dict[str, Tables]] = {
    "paper": {"tolerance": {}},
    "tuned": {"no_push_helps": {}, "astray": {"more": 5.0}},
}
"""Rules by the word for the reward, which decided about the end, too."""


def is_former(plain: Mapping[str, Any]) -> bool:
    """Whether the table of a task is one of an earlier version."""
    return not any(isinstance(plain.get(name), dict) for name in PARTS)


def current_tables(plain: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The same task in the tables of this version.

    Raises:
        ConfigError: A word for observation or reward is not one that earlier versions had.
    """
    observation = _chosen(plain.get("observation", "relative"), OBSERVATIONS, f"{where}: at `observation`")
    reward = _chosen(plain.get("reward", "tuned"), REWARDS, f"{where}: at `reward`")
    return {
        **plain,
        "description": f"Observation `{observation}` and reward `{reward}` of earlier versions",
        "mirrored": observation == "relative",
        "observation": OBSERVATIONS[observation],
        "reward": REWARDS[reward],
        "ending": ENDINGS[reward],
    }


def _chosen(word: object, among: Mapping[str, Tables], where: str) -> str:
    if not isinstance(word, str) or word not in among:
        raise ConfigError(f"{where}: expected one of {', '.join(among)}, got {word!r}")
    return word
