"""Reads the files of a recorded mission that, besides the messages, are needed to run it again."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Final, NamedTuple

import msgspec
from msgspec import Meta, Struct

from legpush.bounds import Count
from legpush.errors import RecordingError, ScenarioError
from legpush.numerics.computed_with import NUMERICS, ComputedWith
from legpush.numerics.current import NUMERICS_FILE
from legpush.numerics.motion_version import MOTIONS
from legpush.recording.mcap_file.contents import Recording
from legpush.runs.folder import SCENARIO_FILE
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario

MISSION_FILE: Final = "mission.json"
VERSIONS_FILE: Final = "versions.json"
PUSH_MAP_FILE: Final = "push_map.json"

STILL: Final = "it cannot be verified or continued here; `legpush info`, `view` and `export` show it as before"
"""What can be done with a recording of another version of the motions."""

CONTINUED: Final = "continued"
"""Key in the metadata of a recording that continues an interrupted mission."""


class MissionFacts(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The inputs of a mission besides its scenario and push map: `mission.json` of a recording."""

    seed: Count
    policy: Annotated[str, Meta(pattern=r"^[^\x00-\x1f\x7f-\x9f-][^\x00-\x1f\x7f-\x9f]*\Z")]
    """Name of the policy, as `--policy` takes it: no flag, and no control characters."""
    policy_sha256: Annotated[str, Meta(pattern=r"^[0-9a-f]*\Z")]
    """SHA-256 of the files of the policy, or of its source file if it is code; empty if it has neither."""


class MissionFiles(NamedTuple):
    """A mission that can be run again."""

    facts: MissionFacts
    scenario: Path
    push_map: Path | None


def read_facts(recording: Recording) -> MissionFacts:
    """Return the inputs of the recorded mission.

    Raises:
        RecordingError: No mission was recorded, or its file cannot be read.
    """
    mission = recording.attachment(MISSION_FILE)
    if mission is None:
        raise RecordingError(
            f"Expected the recording of a mission, with {MISSION_FILE} in it, got one with "
            f"{', '.join(recording.attachments) or 'no files'}"
        )
    try:
        return msgspec.json.decode(mission.data, type=MissionFacts)
    except msgspec.MsgspecError as error:
        raise RecordingError(f"{MISSION_FILE} of the recording: {error}") from error


def scenario_of(recording: Recording) -> Scenario | None:
    """Return the scenario among the files of a recording; None if it has none, or one of another version."""
    attachment = recording.attachment(SCENARIO_FILE)
    return None if attachment is None else scenario_in(attachment.data)


def scenario_in(data: bytes) -> Scenario | None:
    """Return the scenario in the bytes of its file; None if this version cannot read it."""
    with TemporaryDirectory(prefix="legpush-") as folder:
        file = Path(folder) / SCENARIO_FILE
        file.write_bytes(data)
        try:
            return load_scenario(file)
        except ScenarioError:
            return None


def recorded_with(recording: Recording) -> ComputedWith:
    """Return what the simulator computed with, or else the agent, as far as it was noted.

    Raises:
        RecordingError: The file that notes it is damaged.
    """
    simulator, agent = _noted(recording, NUMERICS_FILE), _noted(recording, VERSIONS_FILE)
    return ComputedWith(
        motions=simulator.get(MOTIONS, agent.get(MOTIONS)), numerics=simulator.get("name", agent.get(NUMERICS))
    )


def _noted(recording: Recording, file: str) -> dict[str, str]:
    """Return the texts in a JSON file of the recording by their keys; none if it has no such file."""
    attachment = recording.attachment(file)
    if attachment is None:
        return {}
    try:
        said = msgspec.json.decode(attachment.data, type=dict[str, Any])
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RecordingError(f"{file} of the recording: {error}") from error
    return {key: text for key, text in said.items() if isinstance(text, str)}


def unpack_mission(recording: Recording, folder: Path) -> MissionFiles:
    """Write the files of the recorded mission into a folder.

    Raises:
        RecordingError: No mission was recorded, or it began in another recording: it is a branch, or it was continued
            after an interruption.
    """
    if CONTINUED in recording.about:
        raise RecordingError(
            "Expected the recording of a mission from its beginning on, got one that goes on after an interruption: "
            "plans from before are not in it; it can be verified"
        )
    if "parent_sha256" in recording.about:
        raise RecordingError(
            f"Expected the recording of a mission from its beginning on, got a branch of "
            f"{recording.about.get('parent_file')} at {recording.about.get('parent_episode')}:"
            f"{recording.about.get('parent_step')}; it can be verified, and its parent can be branched and replayed"
        )
    facts, scenario = read_facts(recording), recording.attachment(SCENARIO_FILE)
    if scenario is None:
        raise RecordingError(f"Expected the recording of a mission, with {SCENARIO_FILE} in it, got one without it")
    (folder / SCENARIO_FILE).write_bytes(scenario.data)
    push_map = recording.attachment(PUSH_MAP_FILE)
    if push_map is not None:
        (folder / PUSH_MAP_FILE).write_bytes(push_map.data)
    return MissionFiles(facts, folder / SCENARIO_FILE, folder / PUSH_MAP_FILE if push_map is not None else None)
