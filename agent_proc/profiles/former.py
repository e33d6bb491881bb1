"""Training profiles of earlier versions of legpush, which had a word each for observation and reward."""

from collections.abc import Mapping
from typing import Any, Final

from legpush.errors import ConfigError

TASKS: Final = {("relative", "tuned"): "tuned", ("paper", "paper"): "paper-text"}
"""Built-in tasks of today by the words for observation and reward."""
WORDS: Final = ("observation", "reward")
NAMES: Final = {
    "paper": "the profile `paper` has become three: `paper-text`, as the paper is printed, `release`, as its code was "
    "published, and `paper-learns`, the least change that learns"
}
"""What to say of names that profiles had."""


def is_former(plain: Mapping[str, Any]) -> bool:
    """Whether the table of a profile is one of an earlier version."""
    return "task" not in plain and all(isinstance(plain.get(word), str) for word in WORDS)


def current_table(plain: Mapping[str, Any]) -> dict[str, Any]:
    """The table of a profile that was trained with: its task is only told of, as the card has the whole one."""
    words = (plain["observation"], plain["reward"])
    return {**_rest(plain), "task": TASKS.get(words, "/".join(map(str, words)))}


def usable_table(plain: Mapping[str, Any]) -> dict[str, Any]:
    """The table of a profile to train with.

    Raises:
        ConfigError: There is no built-in task with its observation and reward.
    """
    words = (plain["observation"], plain["reward"])
    if words not in TASKS:
        raise ConfigError(
            f"a profile names its task now, and no built-in one has the observation {words[0]} with the reward "
            f"{words[1]}: write a task file, and `task` with its path in the place of both"
        )
    return {**_rest(plain), "task": TASKS[words]}


def _rest(plain: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in plain.items() if name not in WORDS}
