"""The kind of cell `mission`: a whole mission in one process, in a scenario or in a random room."""

from collections.abc import Collection, Mapping
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from time import perf_counter
from typing import Any, Final, cast

import msgspec
from msgspec import UNSET, Struct, UnsetType

from agent_proc.mission.mission import run_mission
from agent_proc.policies.policy import Policy
from agent_proc.push_model.map import load_push_map
from agent_proc.pushing.solvable import solvable_by
from agent_proc.reporting.mission_record import read_record
from agent_proc.reporting.report import Begun, make_report
from agent_proc.rivals.registry import Rival, make_rival
from agent_proc.studies.cell_parts import (
    STATE_CRC,
    new_simulator,
    path_changes,
    planner,
    policy_with,
    scenario_of,
    sha256_of_policy,
)
from agent_proc.studies.mission_numbers import NUMBERS, TRACKS, numbers, tracks
from agent_proc.studies.phase_numbers import PHASE_COLUMNS, phase_numbers
from agent_proc.task.config import TaskConfig
from agent_proc.task.file import load_task
from agent_proc.task.rooms import RoomFields, room_of
from legpush.errors import ConfigError, MotionError
from legpush.fields import Seed
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.local import LocalWorld
from legpush.messages.planning import Plan, PlanQuery
from legpush.policy_names import DEFAULT_POLICY
from legpush.scenarios.changes import override
from legpush.scenarios.random_room import RandomRoom
from legpush.scenarios.random_scenario import random_scenario
from legpush.scene.names import PlannerName, Steering
from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column
from legpush.versions import installed_versions

FROM_REPORT: Final = (
    Column(name="success", unit="", about="whether the box is at its goal"),
    Column(name="reason", unit="", about="why the mission ended"),
    Column(name="detail", unit="", about="one sentence for people"),
    Column(name="box_position_error_m", unit="m", about="distance of the box from its goal"),
    Column(name="box_angle_error_deg", unit="deg", about="angle of the box from its goal"),
    Column(name="walk_tracking_rms_m", unit="m", about="distance of the trunk from its path, root mean square"),
    Column(name="box_path_rms_m", unit="m", about="distance of the box from its path, root mean square"),
    Column(name="handover_distance_m", unit="m", about="from trunk to box where pushing began"),
    Column(name="trunk_max_abs_pitch_deg", unit="deg", about="largest pitch of the trunk"),
    Column(name="trunk_max_abs_roll_deg", unit="deg", about="largest roll of the trunk"),
    Column(name="min_support_margin_m", unit="m", about="least distance of the CoM from the border of its support"),
    Column(name="n_better_paths", unit="", about="how often the robot took a better path"),
    Column(
        name="n_replans", unit="", about="how often an obstacle appeared in the way, or the robot was thrown off it"
    ),
    Column(name="n_push_cycles", unit="", about="number of pushes"),
    Column(name="n_footsteps", unit="", about="number of footsteps"),
    Column(name="sim_time_s", unit="s", about="simulated time"),
    STATE_CRC,
)
"""Columns that are fields of `report.json`."""
DRAWN: Final = (
    Column(name="n_unsolvable", unit="", about="rooms of the seed that were rejected before, because no way was found"),
    Column(name="drawn_scenario", unit="", about="the room that was drawn, as JSON; empty without a random room"),
)

BLIND: Final[tuple[Rival, ...]] = ("zero", "random", "alternate")
"""Rivals that a mission can ask: they decide by what they see alone."""
LEVEL: Final = "push-l4"
"""Task whose actions and stop rule they have."""
N_ROOMS: Final = 256
"""Drawn rooms that a worker keeps: cells with other policies or profiles have the same, and drawing may take a minute.
"""


class MissionCell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A mission as a study file sets it."""

    seed: Seed = 0
    """Seed of the offsets of start and box, of the paths, and of a random room."""
    scenario: str | None = None
    """A built-in scenario or the path of a scenario file; `default` if there is no random room either."""
    random_room: RoomFields | None = None
    """Draw the room from the seed, as `legpush scenarios random` does."""
    policy: str = DEFAULT_POLICY
    """The policy that chooses the pushes, or a rival of one: `zero`, `random` or `alternate`."""
    push_map: str | None = None
    """The push map of this box, measured by `legpush calibrate`."""
    planner: PlannerName | None = None
    """Replaces the scenario's search."""
    steering: Steering | None = None
    """Replaces the scenario's steering of paths."""
    turning_radius_m: float | None = None
    """Replaces the least turning radius of the robot's paths."""
    changes: dict[str, Any] = {}
    """Other fields of the scenario, by their path; a random room gets them after it was drawn."""


class ResolvedMission(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A mission that needs no other file than those whose hashes it has."""

    seed: Seed
    scenario: Scenario | None
    """None for a room that is drawn."""
    random_room: RandomRoom | None
    changes: dict[str, Any]
    """To be made to a room that is drawn."""
    policy: str
    policy_sha256: str
    """Empty for a rival."""
    push_map: str | None
    push_map_sha256: str | None
    task: TaskConfig | UnsetType = UNSET
    """Of a rival."""


def resolve(cell: MissionCell, allowed: Collection[str]) -> ResolvedMission:
    """Load scenario and hashes.

    Raises:
        ConfigError: There are both a scenario and a random room, or the push map cannot be read.
        ScenarioError: The scenario or a change cannot be used.
        PolicyError: The policy cannot be used.
    """
    if cell.scenario is not None and cell.random_room is not None:
        raise ConfigError(f"Expected either a scenario or a random room, got both: {cell.scenario}")
    changes = {**cell.changes, **path_changes(cell.planner, cell.steering, cell.turning_radius_m)}
    scenario, room = None, None
    if cell.random_room is None:
        scenario = scenario_of(cell.scenario or "default", changes)
    else:
        room = room_of(cell.random_room)
    is_rival = cell.policy in BLIND
    return ResolvedMission(
        seed=cell.seed,
        scenario=scenario,
        random_room=room,
        changes={} if scenario is not None else changes,
        policy=cell.policy,
        policy_sha256="" if is_rival else sha256_of_policy(cell.policy, allowed),
        task=load_task(LEVEL) if is_rival else UNSET,
        push_map=cell.push_map,
        push_map_sha256=None if cell.push_map is None else _sha256(Path(cell.push_map)),
    )


def run(cell: ResolvedMission) -> Mapping[str, Any]:
    """Draw the room if there is one to draw, run the mission, and measure it."""
    scenario, n_unsolvable = (cell.scenario, None) if cell.scenario is not None else drawn(cell)
    push_map = None
    if cell.push_map is not None:
        if (got := _sha256(Path(cell.push_map))) != cell.push_map_sha256:
            raise ConfigError(f"Expected the push map {cell.push_map} of the study, got another one ({got[:16]})")
        push_map = load_push_map(Path(cell.push_map), scenario.box)
    records: list[StepRecord | PlanRecord] = []
    world = LocalWorld(new_simulator(), planner(), on_record=records.append)
    began_s = perf_counter()
    result = run_mission(world, scenario, cell.seed, _policy(cell), push_map)
    if result.error is not None and not isinstance(result.error, MotionError):
        raise result.error  # a motion that was refused is the robot's failure, and has a row
    record = read_record(records)
    report = make_report(record, result, perf_counter() - began_s, installed_versions(), Begun(policy=cell.policy))
    return {
        **{column.name: getattr(report, column.name) for column in FROM_REPORT},
        **phase_numbers(report),
        **numbers(record),
        **tracks(record),
        "n_unsolvable": n_unsolvable,
        "drawn_scenario": "" if n_unsolvable is None else msgspec.json.encode(scenario).decode(),
    }


def _policy(cell: ResolvedMission) -> Policy:
    if cell.task is UNSET:
        return policy_with(cell.policy, cell.policy_sha256)
    return make_rival(cast(Rival, cell.policy), cell.task)


def drawn(cell: ResolvedMission) -> tuple[Scenario, int]:
    """Draw the room of a cell, and return how many rooms were rejected before because no way was found."""
    room, n_unsolvable = _room(cell.random_room or RandomRoom(), cell.seed)
    return override(room, cell.changes), n_unsolvable


@lru_cache(maxsize=N_ROOMS)
def _room(options: RandomRoom, seed: int) -> tuple[Scenario, int]:
    answers: list[bool] = []
    solvable = solvable_by(first_plan, seed)

    def ask(scenario: Scenario) -> bool:
        answers.append(solvable(scenario))
        return answers[-1]

    return random_scenario(options, seed, ask), answers.count(False)


def first_plan(query: PlanQuery) -> Plan:
    """Return the planner's first answer."""
    return next(iter(planner()(query, lambda: False)))


def _sha256(path: Path) -> str:
    try:
        return sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise ConfigError(f"{path}: expected a push map ({error.strerror})") from error


MISSION: Final = CellKind(
    specification=MissionCell,
    run=run,
    resolved=ResolvedMission,
    resolve=resolve,
    columns=(*FROM_REPORT, *PHASE_COLUMNS, *NUMBERS, *TRACKS, *DRAWN),
    changes=Scenario,
)
"""The kind of cell."""
