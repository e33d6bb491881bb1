"""Profiles of earlier versions: what they were trained with is told, and what can be trained with is a task."""

from pathlib import Path

import pytest

from agent_proc.profiles.profile import dump_profile, load_profile, profile_names, read_profile
from agent_proc.task.file import load_task
from legpush.errors import ConfigError

FORMER = """description = "mine"
algorithm = "ppo"
steps = 10
observation = "{observation}"
reward = "{reward}"
"""


@pytest.mark.parametrize(
    ("observation", "reward", "task"), [("relative", "tuned", "tuned"), ("paper", "paper", "paper-text")]
)
def test_a_file_with_both_words_trains_the_task_of_today(
    tmp_path: Path, observation: str, reward: str, task: str
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(FORMER.format(observation=observation, reward=reward))
    profile = load_profile(str(path))

    assert profile.task == task
    assert "\nobservation =" not in dump_profile(profile)


def test_a_file_whose_words_make_no_task_says_what_to_write(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(FORMER.format(observation="relative", reward="paper"))

    with pytest.raises(ConfigError, match=r"mine\.toml: a profile names its task now.* relative .* paper: write"):
        load_profile(str(path))


def test_the_profile_of_a_card_keeps_its_words() -> None:
    plain = {"description": "x", "algorithm": "sac", "steps": 3, "observation": "relative", "reward": "paper"}

    assert read_profile(plain, "card").task == "relative/paper"


def test_a_name_of_former_times_says_what_became_of_it() -> None:
    with pytest.raises(ConfigError, match=r"got 'paper': .* `paper-text`, .* `release`, .* `paper-learns`"):
        load_profile("paper")


@pytest.mark.parametrize("name", profile_names())
def test_every_profile_names_a_task_that_can_be_loaded(name: str) -> None:
    assert load_task(load_profile(name).task).max_steps == 200
