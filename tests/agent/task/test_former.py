"""Tasks of earlier versions: their words mean what they meant."""

from typing import Any

import msgspec
import pytest

from agent_proc.task.file import load_task, read_task
from agent_proc.task.former import current_tables, is_former
from legpush.errors import ConfigError
from legpush.scenarios.file import scenario_table
from tests.agent.fake_world import scenario_at_station

SCENARIO = scenario_at_station()


def former(**fields: Any) -> dict[str, Any]:
    """The table of a task as cards had it."""
    usual = {
        "entry": "fixed",
        "action_form": "continuous",
        "observation": "relative",
        "reward": "tuned",
        "fixed_depth_m": 0.05,
        "least_depth_m": 0.005,
        "max_depth_m": 0.1,
        "limit_depth": True,
        "max_steps": 200,
        "scenario": scenario_table(SCENARIO),
        "domain": {"mass_kg": None, "friction": None, "distance_m": [0.1, 1.0]},
    }
    return {**usual, **fields}


@pytest.mark.parametrize(
    ("words", "name"), [(("relative", "tuned"), "tuned"), (("paper", "paper"), "paper-text")], ids=["tuned", "paper"]
)
def test_both_words_of_a_profile_are_a_task_of_today(words: tuple[str, str], name: str) -> None:
    task = read_task(former(observation=words[0], reward=words[1]), "card")
    today = load_task(name, SCENARIO, entry="fixed", description="", domain={"distance_m": [0.1, 1.0]})

    for field in ("entry", "mirrored", "observation", "reward", "ending", "max_steps", "scenario", "limit_depth"):
        assert getattr(task, field) == getattr(today, field)
    assert task.domain.distance_m == (0.1, 1.0)
    assert task.domain.box_xy_m is None


def test_words_may_be_mixed_and_the_one_for_the_reward_decides_about_the_end() -> None:
    task = read_task(former(observation="relative", reward="paper"), "card")

    assert (task.mirrored, next(iter(task.observation)), list(task.ending)) == (True, "box", ["tolerance"])


def test_a_table_without_words_is_one_of_the_first_version() -> None:
    plain = former()
    del plain["observation"], plain["reward"]

    assert is_former(plain)
    assert read_task(plain, "card") == read_task(former(), "card")


def test_a_table_of_today_is_not_touched() -> None:
    plain = msgspec.to_builtins(load_task("release", SCENARIO))

    assert not is_former(plain)
    assert read_task(plain, "card") == load_task("release", SCENARIO)


@pytest.mark.parametrize(("field", "got"), [("observation", "'absolute'"), ("reward", "3")])
def test_a_word_that_never_was_is_refused(field: str, got: str) -> None:
    words = {"observation": "absolute", "reward": 3}
    with pytest.raises(ConfigError, match=rf"card: at `{field}`: expected one of .*, got {got}"):
        current_tables(former(**{field: words[field]}), "card")
