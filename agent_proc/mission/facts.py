"""Facts about a mission that a recording keeps besides the messages."""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import msgspec

from agent_proc.policies.folder import CARD_FILE, NETWORKS_FILE, NORMALIZER_FILE, policy_path, shipped_policies
from agent_proc.policies.registry import GROUP, SB3_SUFFIX
from legpush.bus.bus import Bus
from legpush.plugins import plugin_names
from legpush.recording.facts import MISSION_FILE, PUSH_MAP_FILE, VERSIONS_FILE, MissionFacts
from legpush.runs.folder import SCENARIO_FILE
from legpush.scenarios.file import dump_scenario
from legpush.scene.scenario import Scenario

JSON: Final = "application/json"


def policy_sha256(name: str) -> str:
    """SHA-256 of the files of a policy by name; empty if the policy is code alone."""
    if ":" in name or (name in plugin_names(GROUP) and name not in shipped_policies()):
        return ""
    folder = Path(name) if name.endswith(SB3_SUFFIX) else policy_path(name)
    paths = [folder] if folder.is_file() else [folder / file for file in (CARD_FILE, NETWORKS_FILE, NORMALIZER_FILE)]
    digest = hashlib.sha256()
    for path in paths:
        if path.exists():
            digest.update(path.read_bytes())
    return digest.hexdigest()


def attach_facts(
    bus: Bus, scenario: Scenario, seed: int, policy: str, push_map: Path | None, versions: Mapping[str, str]
) -> None:
    """Attach the facts about a mission to the bus, for recorders."""
    facts = MissionFacts(seed=seed, policy=policy, policy_sha256=policy_sha256(policy))
    bus.attach(MISSION_FILE, JSON, msgspec.json.encode(facts))
    bus.attach(VERSIONS_FILE, JSON, msgspec.json.encode(dict(versions)))
    bus.attach(SCENARIO_FILE, "application/toml", dump_scenario(scenario).encode())
    if push_map is not None:
        bus.attach(PUSH_MAP_FILE, JSON, push_map.read_bytes())
