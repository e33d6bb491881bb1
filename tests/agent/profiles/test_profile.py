"""Training profiles."""

import tomllib
from pathlib import Path

import pytest

from agent_proc.profiles.profile import PpoProfile, dump_profile, load_profile, profile_names, read_profile
from legpush.errors import ConfigError


def test_the_built_in_profiles_are_there() -> None:
    assert profile_names() == ("paper", "sac", "td3", "tuned")


@pytest.mark.parametrize("name", ["paper", "sac", "td3", "tuned"])
def test_a_profile_survives_a_round_trip(name: str) -> None:
    profile = load_profile(name)

    assert read_profile(tomllib.loads(dump_profile(profile)), "here") == profile
    assert profile.algorithm == {"paper": "ppo", "tuned": "ppo"}.get(name, name)


def test_the_profile_paper_is_the_published_one() -> None:
    profile = load_profile("paper")

    assert isinstance(profile, PpoProfile)
    assert profile.network.hidden == (512,) * 4
    assert profile.network.activation == "relu"
    settings = profile.settings
    assert (settings.learning_rate, settings.batch_size, settings.gamma) == (1e-3, 512, 0.99)
    assert (settings.n_steps, settings.n_epochs, settings.gae_lambda, settings.clip_range) == (2048, 10, 0.95, 0.2)
    assert (profile.observation, profile.reward) == ("paper", "paper")
    assert not profile.normalize_observation
    assert not profile.normalize_reward


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
    head = 'description = "x"\nobservation = "paper"\nreward = "paper"\n'
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
    with pytest.raises(ConfigError, match=r"paper, sac, td3, tuned.* for --profile, got 'best'"):
        load_profile("best")
