"""Training profiles."""

import tomllib
from pathlib import Path

import pytest
from msgspec.structs import replace

from agent_proc.profiles.profile import PpoProfile, dump_profile, load_profile, profile_names, read_profile
from legpush.errors import ConfigError


def test_the_built_in_profiles_are_there() -> None:
    assert profile_names() == ("paper-learns", "paper-observation", "paper-text", "release", "sac", "td3", "tuned")


@pytest.mark.parametrize("name", profile_names())
def test_a_profile_survives_a_round_trip(name: str) -> None:
    profile = load_profile(name)

    assert read_profile(tomllib.loads(dump_profile(profile)), "here") == profile
    assert profile.algorithm == (name if name in ("sac", "td3") else "ppo")


def test_the_profile_of_the_printed_paper_has_its_settings() -> None:
    profile = load_profile("paper-text")

    assert isinstance(profile, PpoProfile)
    assert profile.network.hidden == (512,) * 4
    assert profile.network.activation == "relu"
    settings = profile.settings
    assert (settings.learning_rate, settings.batch_size, settings.gamma) == (1e-3, 512, 0.99)
    assert (settings.n_steps, settings.n_epochs, settings.gae_lambda, settings.clip_range) == (2048, 10, 0.95, 0.2)
    assert profile.task == "paper-text"
    assert not profile.normalize_observation
    assert not profile.normalize_reward


@pytest.mark.parametrize(("name", "activation", "n_steps"), [("release", "tanh", 2048), ("paper-learns", "relu", 512)])
def test_the_other_profiles_of_the_paper_differ_in_what_they_say(name: str, activation: str, n_steps: int) -> None:
    text, other = load_profile("paper-text"), load_profile(name)
    assert isinstance(text, PpoProfile)
    assert isinstance(other, PpoProfile)

    assert (other.task, other.network.activation, other.settings.n_steps) == (name, activation, n_steps)
    assert replace(other.settings, n_steps=2048) == text.settings
    assert (other.network.hidden, other.normalize_observation) == (text.network.hidden, text.normalize_observation)


def test_the_observation_of_the_paper_kept_has_the_published_network_but_normalizes_and_updates_more_often() -> None:
    text, kept = load_profile("paper-text"), load_profile("paper-observation")
    assert isinstance(text, PpoProfile)
    assert isinstance(kept, PpoProfile)

    assert (kept.task, kept.network, kept.steps) == ("paper-observation", text.network, text.steps)
    assert kept.settings == replace(text.settings, n_steps=256, batch_size=64)
    assert (kept.normalize_observation, kept.normalize_reward) == (True, False)


def test_the_task_of_a_profile_is_named_from_its_own_folder(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('description = "x"\nalgorithm = "ppo"\nsteps = 1\ntask = "tasks/mine.toml"\n')

    assert load_profile(str(path)).task == str(tmp_path / "tasks/mine.toml")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('algorithm = "dqn"', r"at `algorithm`: expected one of ppo, sac, td3, got 'dqn'"),
        ("", r"at `algorithm`: expected one of ppo, sac, td3, got None"),
        ('algorithm = ["ppo"]', r"at `algorithm`: expected one of ppo, sac, td3, got \['ppo'\]"),
        ("[settings]\ngama = 1", r"unknown field \(did you mean `gamma`\?\)"),
        ("[settings]\ngamma = 2.0", r"at `settings.gamma`"),
        ("[network]\nhidden = []", r"at `network.hidden`"),
        ("steps = 0", r"at `steps`"),
        ("steps = ", r"expected a training profile in TOML"),
    ],
)
def test_a_wrong_profile_is_refused_with_the_field(tmp_path: Path, text: str, message: str) -> None:
    head = 'description = "x"\ntask = "tuned"\n'
    head += "" if "steps" in text else "steps = 10\n"
    head += "" if "algorithm" in text or not text else 'algorithm = "ppo"\n'
    path = tmp_path / "mine.toml"
    path.write_text(head + text, encoding="utf-8")

    with pytest.raises(ConfigError, match=message) as caught:
        load_profile(str(path))
    assert "mine.toml" in str(caught.value)


def test_a_profile_that_is_no_table_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"config\.json: profile: expected the table of a training profile, got 3"):
        read_profile(3, "config.json: profile")


def test_an_unknown_profile_is_refused_with_the_names() -> None:
    with pytest.raises(ConfigError, match=r"paper-learns, .*, tuned.* for --profile, got 'best'"):
        load_profile("best")
