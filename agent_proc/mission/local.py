"""The mission of this package as a plug-in: run in any world, and reported from what that world recorded."""

from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

from agent_proc.mission.mission import run_mission
from agent_proc.policies.registry import make_policy, user_policy
from agent_proc.push_model.map import load_push_map
from agent_proc.reporting.mission_record import read_record
from agent_proc.reporting.report import Begun, make_report
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.mission import Tell
from legpush.lockstep.world import World
from legpush.runs.report import Report
from legpush.scene.scenario import Scenario
from legpush.versions import installed_versions


def run_local(
    world: World,
    scenario: Scenario,
    *,
    seed: int,
    policy: object,
    trust_policy_file: bool,
    push_map: Path | None,
    records: Sequence[StepRecord | PlanRecord],
    tell: Tell,
) -> Report:
    """Run the mission; a `legpush.lockstep.mission.Mission`.

    Raises:
        PolicyError: There is no such policy, or it has no method `decide`.
        ConfigError: The push map cannot be used with the scenario's box.
        LegpushError: Planner, simulator or policy failed, or gave an answer that cannot be used.
    """
    decides = make_policy(policy, trust_file=trust_policy_file) if isinstance(policy, str) else user_policy(policy)
    measured = None if push_map is None else load_push_map(push_map, scenario.box)
    began_s = perf_counter()
    result = run_mission(world, scenario, seed, decides, measured, tell=tell)
    wall_time_s = perf_counter() - began_s
    if result.error is not None:
        raise result.error
    return make_report(read_record(records), result, wall_time_s, installed_versions(), Begun(policy=_named(policy)))


def _named(policy: object) -> str:
    """Return the name of a policy, or of the type of an object."""
    return policy if isinstance(policy, str) else f"{type(policy).__module__}.{type(policy).__qualname__}"
