"""Policy folders: written whole, read with every file checked."""

import dataclasses
import json
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np
import pytest

from agent_proc.policies.actor import Normalizer
from agent_proc.policies.card import CARD_FILE
from agent_proc.policies.folder import (
    PolicyFolder,
    is_old_format,
    policy_path,
    read_card,
    read_policy,
    shipped_policies,
    widths,
    write_policy,
)
from agent_proc.policies.weights_file import encode_weights
from agent_proc.profiles.profile import load_profile
from legpush.errors import PolicyError
from tests.agent.fake_world import scenario_at_station
from tests.agent.policies.policies import CARD, random_layers
from tests.agent.tasks import tuned

POLICY = PolicyFolder(
    card=CARD,
    layers=random_layers(8, 64, 64, 4),
    normalizer=Normalizer(mean=np.linspace(0.0, 1.0, 8), variance=np.ones(8), clip=5.0),
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A policy to damage."""
    write_policy(tmp_path / "policy", POLICY)
    return tmp_path / "policy"


def test_a_policy_is_read_as_it_was_written(folder: Path) -> None:
    again = read_policy(folder)

    assert again.card == POLICY.card
    assert (again.card.world, again.card.init) == ("map", "variable")
    assert encode_weights(again.layers, again.normalizer) == encode_weights(POLICY.layers, POLICY.normalizer)
    assert sorted(path.name for path in folder.iterdir()) == ["README.md", "card.json", "policy.safetensors"]


def test_the_card_and_the_readme_name_every_number_that_goes_in_and_out(folder: Path) -> None:
    card, text = json.loads((folder / CARD_FILE).read_bytes()), (folder / "README.md").read_text(encoding="utf-8")

    for field, n_elements in (("observation", 8), ("action", 4)):
        assert len(card[field]) == n_elements
        for element in card[field]:
            assert f"| {element['name']} |" in text


def test_a_card_with_other_elements_than_this_version_has_is_refused(folder: Path) -> None:
    plain = json.loads((folder / CARD_FILE).read_bytes())
    plain["observation"][0]["unit"] = "cm"
    (folder / CARD_FILE).write_text(json.dumps(plain), encoding="utf-8")

    with pytest.raises(PolicyError, match=r"at `observation`: expected the elements of this version, \[\('box.x', 'm'"):
        read_card(folder)


def test_a_card_of_the_earlier_format_is_refused_with_the_command_that_converts_it(folder: Path) -> None:
    plain = json.loads((folder / CARD_FILE).read_bytes())
    assert not is_old_format(folder)
    (folder / CARD_FILE).write_text(json.dumps({**plain, "format": 1}), encoding="utf-8")

    assert is_old_format(folder)
    with pytest.raises(PolicyError, match=r"got format 1, which .*`legpush policy export .*policy --to safetensors"):
        read_policy(folder)


def test_a_card_of_a_format_to_come_is_refused(folder: Path) -> None:
    plain = json.loads((folder / CARD_FILE).read_bytes())
    (folder / CARD_FILE).write_text(json.dumps({**plain, "format": 4}), encoding="utf-8")

    with pytest.raises(PolicyError, match=r"card\.json: at `format`: expected 3 or 2, got 4"):
        read_policy(folder)


@pytest.mark.parametrize(
    ("algorithm", "form", "output", "n_values"),
    [("tuned", "continuous", "clip", 3), ("sac", "continuous", "tanh", 3), ("tuned", "discrete", "argmax", 18)],
)
def test_the_output_of_the_network_follows_from_algorithm_and_action(
    algorithm: str, form: Literal["continuous", "discrete"], output: str, n_values: int
) -> None:
    task = tuned(entry="fixed", action_form=form, scenario=scenario_at_station())
    card = dataclasses.replace(CARD, task=task, profile=load_profile(algorithm))

    assert widths(card) == (8, *card.profile.network.hidden, n_values)
    assert PolicyFolder(card=card, layers=random_layers(*widths(card)), normalizer=None).actor().output == output


def test_a_card_names_the_field_that_is_wrong(folder: Path) -> None:
    plain = json.loads((folder / CARD_FILE).read_bytes())
    (folder / CARD_FILE).write_text(json.dumps({**plain, "seed": "seven"}), encoding="utf-8")

    with pytest.raises(PolicyError, match=r"card\.json: expected the card of a policy \(Expected `int`, got `str`"):
        read_card(folder)


def test_a_card_with_a_wrong_profile_or_task_is_refused_too(folder: Path) -> None:
    plain = json.loads((folder / CARD_FILE).read_bytes())
    for part, change, message in (
        (
            "profile",
            {"algorithm": "dqn"},
            r"card\.json: profile: at `algorithm`: expected one of ppo, sac, td3, got 'dqn'",
        ),
        ("task", {"max_steps": 0}, r"card\.json: task: at `max_steps`: expected a whole number from 1 to 10000, got 0"),
    ):
        changed = {**plain, part: {**plain[part], **change}}
        (folder / CARD_FILE).write_text(json.dumps(changed), encoding="utf-8")
        with pytest.raises(PolicyError, match=message):
            read_card(folder)


def test_a_policy_without_normalization_needs_no_normalizer(tmp_path: Path) -> None:
    profile = msgspec.structs.replace(CARD.profile, normalize_observation=False)
    bare = PolicyFolder(card=dataclasses.replace(CARD, profile=profile), layers=POLICY.layers, normalizer=None)

    write_policy(tmp_path / "bare", bare)

    assert read_policy(tmp_path / "bare").normalizer is None


def test_only_folders_with_a_card_are_shipped_policies() -> None:
    assert shipped_policies() == ("fixed", "variable", "wide")
    assert all((policy_path(name) / CARD_FILE).is_file() for name in shipped_policies())


def test_a_path_that_is_no_folder_is_refused_with_the_valid_names(tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match=r"Expected a policy \(dynamic_programming, .*wide\) or the folder of one"):
        policy_path(str(tmp_path / "none"))
