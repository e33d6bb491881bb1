from pathlib import Path

import pytest

from agent_proc.profiles.profile import load_profile
from agent_proc.studies.tuning.space import load_space, space_names
from legpush.errors import ConfigError


def load(text: str, tmp_path: Path, profile: str = "tuned") -> object:
    path = tmp_path / "space.toml"
    path.write_text(text, encoding="utf-8")
    return load_space(str(path), load_profile(profile))


@pytest.mark.parametrize("name", ["ppo", "sac", "td3"])
def test_every_built_in_space_fits_its_algorithm_and_is_its_default(name: str) -> None:
    assert name in space_names()
    profile = load_profile({"ppo": "tuned"}.get(name, name))
    space = load_space(None, profile)
    assert space == load_space(name, profile)
    assert len(space.parameters) >= 7


def test_values_replace_those_of_the_profile_and_its_own_are_known() -> None:
    space = load_space("ppo", load_profile("tuned"))
    own = space.values_of_profile()
    assert own is not None
    assert own["network.hidden"] == [64, 64]
    assert space.profile_with(own) == space.profile
    changed = space.profile_with({"network.hidden": [32, 32], "settings.gamma": 0.95}, description="mine")
    assert (changed.network.hidden, changed.settings.gamma, changed.description) == ((32, 32), 0.95, "mine")
    assert load_space("ppo", load_profile("paper-text")).values_of_profile() is None, "a value is outside the space"


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("[search]\n", "expected fields of a training profile, got none"),
        ('[search."settings.rate"]\nlow = 1\nhigh = 2', "at `search.settings.rate`: expected a field of the profile"),
        ('[search."settings.gamma"]\nlow = 0.5', "expected low and high, or choices"),
        ('[search."settings.gamma"]\nlow = 0.5\nhigh = 0.5', "expected low < high, got 0.5 and 0.5"),
        ('[search."settings.gamma"]\nlow = 0\nhigh = 1\nlog = true', "expected low above 0 with log"),
        (
            '[search."settings.gamma"]\nlow = 0.5\nhigh = 1.5',
            "`search.settings.gamma`: .*a number from 0 to 1, got 1.5",
        ),
        ('[search."settings.gamma"]\nchoices = [0.9]', "expected at least two choices"),
        ('[search."settings.gamma"]\nchoices = [0.9, 0.8]\nlow = 0.1', "got both"),
        ('[search."settings.gamma"]\nlowest = 0.1', "lowest"),
        ("search = 3", "search"),
    ],
)
def test_a_space_that_does_not_fit_is_refused(text: str, match: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=match):
        load(text, tmp_path)


def test_an_unknown_space_is_refused_with_the_names() -> None:
    with pytest.raises(ConfigError, match=r"Expected the name of a search space \(ppo, sac, td3\) or the path"):
        load_space("cma", load_profile("tuned"))
