"""Policy folders: written whole, read with every file checked."""

import json
from pathlib import Path

import msgspec
import numpy as np
import pytest

from agent_proc.policies.folder import (
    CARD_FILE,
    Card,
    Check,
    CurvePoint,
    Normalizer,
    PolicyFolder,
    policy_path,
    read_card,
    read_policy,
    shipped_policies,
    write_policy,
)
from agent_proc.profiles.profile import load_profile
from agent_proc.task.config import TaskConfig
from legpush.errors import PolicyError
from tests.agent.fake_world import scenario_at_station

EMPTY_ZIP = b"PK\x05\x06" + bytes(18)
CHECK = Check(step=64, seeds=(1, 2), success_rate=0.5, position_error_m=0.02, angle_error_deg=1.5, falls=0, cycles=20.0)
CARD = Card(
    command="legpush train --seed 7",
    task=TaskConfig(scenario=scenario_at_station()),
    profile=load_profile("tuned"),
    seed=7,
    steps=64,
    n_simulators=2,
    versions={"numpy": "1"},
    check=CHECK,
    curve=(CurvePoint(step=3, episode_return=-1.5, length=3, success=False, position_error_m=0.4, angle_error_deg=9),),
)
POLICY = PolicyFolder(
    card=CARD, networks=EMPTY_ZIP, normalizer=Normalizer(mean=(0.0,) * 8, variance=(1.0,) * 8, clip=5.0)
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A policy to damage."""
    write_policy(tmp_path / "policy", POLICY)
    return tmp_path / "policy"


def test_a_policy_is_read_as_it_was_written(folder: Path) -> None:
    assert read_policy(folder) == POLICY


def test_the_readme_says_how_the_policy_came_about(folder: Path) -> None:
    text = (folder / "README.md").read_text(encoding="utf-8")

    assert "legpush train --seed 7" in text
    assert "success 50%, 2.00 cm, 1.50°, 20 cycles, 0 falls (n = 2)" in text


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
        ("task", {"max_steps": 0}, r"card\.json: Expected at least 1 for max_steps, got 0"),
    ):
        changed = {**plain, part: {**plain[part], **change}}
        (folder / CARD_FILE).write_text(json.dumps(changed), encoding="utf-8")
        with pytest.raises(PolicyError, match=message):
            read_card(folder)


def test_a_policy_without_normalization_needs_no_normalizer(tmp_path: Path) -> None:
    profile = msgspec.structs.replace(CARD.profile, normalize_observation=False)
    bare = PolicyFolder(
        card=Card(**{**{name: getattr(CARD, name) for name in CARD.__dataclass_fields__}, "profile": profile}),
        networks=EMPTY_ZIP,
        normalizer=None,
    )

    write_policy(tmp_path / "bare", bare)

    assert read_policy(tmp_path / "bare").normalizer is None
    assert not (tmp_path / "bare" / "normalizer.json").exists()


def test_an_observation_is_normalized_and_clipped() -> None:
    normalizer = Normalizer(mean=(1.0, 0.0), variance=(4.0, 1e-8), clip=5.0, epsilon=0.0)

    seen = normalizer.apply(np.array([2.0, 1.0], dtype=np.float32))

    assert seen.dtype == np.float32
    np.testing.assert_allclose(seen, [0.5, 5.0])


def test_only_folders_with_a_card_are_shipped_policies() -> None:
    assert shipped_policies() == ("fixed", "variable")
    assert all((policy_path(name) / CARD_FILE).is_file() for name in shipped_policies())


def test_a_path_that_is_no_folder_is_refused_with_the_valid_names(tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match=r"Expected a policy \(fixed, scripted, variable\) or the folder of one"):
        policy_path(str(tmp_path / "none"))
