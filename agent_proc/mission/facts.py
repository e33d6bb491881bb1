"""Facts about a mission that a recording keeps besides the messages."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import msgspec

from agent_proc.policies.digest import policy_sha256
from legpush.bus.bus import Bus
from legpush.recording.facts import MISSION_FILE, PUSH_MAP_FILE, VERSIONS_FILE, MissionFacts
from legpush.runs.folder import SCENARIO_FILE
from legpush.scenarios.file import dump_scenario
from legpush.scene.scenario import Scenario

JSON: Final = "application/json"


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
