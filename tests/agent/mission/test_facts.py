"""What a recording keeps of a mission besides its messages."""

import hashlib
from pathlib import Path

import msgspec
import pytest

from agent_proc.mission.facts import attach_facts
from agent_proc.policies.card import CARD_FILE
from agent_proc.policies.digest import policy_sha256
from agent_proc.policies.folder import WEIGHTS_FILE
from legpush.recording.facts import MissionFacts
from legpush.scenarios.file import load_scenario
from tests.agent.fake_world import make_scenario
from tests.legpush.bus.memory_session import KeptBatches, MemoryNetwork


@pytest.mark.parametrize("policy", ["scripted", "my_module:make_policy"])
def test_a_policy_that_is_code_alone_has_no_digest(policy: str) -> None:
    assert policy_sha256(policy) == ""


def test_the_digest_of_a_policy_folder_is_that_of_its_card_and_weights(tmp_path: Path) -> None:
    for file, text in ((WEIGHTS_FILE, "2"), (CARD_FILE, "1"), ("README.md", "3")):
        (tmp_path / file).write_text(text, encoding="utf-8")

    assert policy_sha256(str(tmp_path)) == hashlib.sha256(b"12").hexdigest()


def test_the_digest_of_a_model_file_is_that_of_its_bytes(tmp_path: Path) -> None:
    (tmp_path / "model.zip").write_bytes(b"model")

    assert policy_sha256(str(tmp_path / "model.zip")) == hashlib.sha256(b"model").hexdigest()


def test_policies_that_are_shipped_have_digests_of_their_own() -> None:
    fixed, variable = policy_sha256("fixed"), policy_sha256("variable")

    assert len(fixed) == len(variable) == 64
    assert fixed != variable


def attached(push_map: Path | None) -> dict[str, bytes]:
    """The files that a mission hands to a recorder, by name."""
    network = MemoryNetwork()
    with network.bus("recorder") as recording:
        recorder = KeptBatches(recording, "agent")
        with network.bus("agent", recorded=True) as agent:
            attach_facts(agent, make_scenario(), 5, "scripted", push_map, {"numpy": "2.0"})
            recording.announce()
    return {fact.name: fact.data for batch in recorder.batches for fact in batch.facts}


def test_seed_policy_versions_and_scenario_are_attached(tmp_path: Path) -> None:
    files = attached(None)

    assert sorted(files) == ["mission.json", "scenario.toml", "versions.json"]
    facts = msgspec.json.decode(files["mission.json"], type=MissionFacts)
    assert facts == MissionFacts(seed=5, policy="scripted", policy_sha256="")
    assert msgspec.json.decode(files["versions.json"]) == {"numpy": "2.0"}
    (tmp_path / "scenario.toml").write_bytes(files["scenario.toml"])
    assert load_scenario(tmp_path / "scenario.toml") == make_scenario()


def test_a_push_map_is_attached_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "measured.json").write_bytes(b"a map")

    assert attached(tmp_path / "measured.json")["push_map.json"] == b"a map"
