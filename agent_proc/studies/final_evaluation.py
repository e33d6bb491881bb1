"""A further evaluation of a trained policy: from starts that nothing was chosen on, episode by episode."""

from collections.abc import Sequence
from typing import Any, Final

from msgspec.structs import replace

from agent_proc.evaluation.episodes import evaluate
from agent_proc.evaluation.starts import FIRST_FINAL_SEED, starts_of
from agent_proc.policies.folder import PolicyFolder
from agent_proc.policies.learned import NetworkPolicy
from agent_proc.task.config import TaskConfig
from legpush.lockstep.world import SteppingWorld
from legpush.realism.settings import Randomization
from legpush.study.cells import Column

NOMINAL: Final = "nominal"
DRAWN: Final = "drawn"
"""Cases: the start without offsets, and starts with those of the scenario."""
FINAL_COLUMNS: Final = (
    Column(name="final_success", unit="", about="by each start: whether the last policy was done, within tolerances"),
    Column(name="final_ended", unit="", about="by each start: `done`, `fell`, `astray` or `max_cycles`"),
    Column(name="final_position_error_m", unit="m", about="by each start"),
    Column(name="final_angle_error_deg", unit="deg", about="by each start"),
    Column(name="final_n_cycles", unit="", about="by each start: number of pushes"),
    Column(name="final_simulated_s", unit="s", about="by each start: simulated time of the episode"),
    Column(name="nominal_success", unit="", about="the same of the one start without offsets"),
    Column(name="nominal_position_error_m", unit="m", about="of the one start without offsets"),
    Column(name="nominal_angle_error_deg", unit="deg", about="of the one start without offsets"),
    Column(name="nominal_n_cycles", unit="", about="of the one start without offsets"),
)


def final_columns(
    policy: PolicyFolder,
    task: TaskConfig,
    worlds: Sequence[SteppingWorld],
    n_starts: int,
    first_seed: int = FIRST_FINAL_SEED,
) -> dict[str, Any]:
    """Evaluate a policy in `task`, which has the observation and the actions of its own; without starts, no values."""
    if not n_starts:
        return {column.name: None for column in FINAL_COLUMNS}
    scenario = task.scenario
    decider = NetworkPolicy(task, policy.actor(), policy.normalizer, "the policy that was trained")
    nominal = replace(scenario, randomization=Randomization())
    (alone,) = evaluate(worlds[:1], {NOMINAL: nominal}, [first_seed], decider)
    seeds = range(first_seed, first_seed + n_starts)
    rows = evaluate(worlds, {DRAWN: scenario}, seeds, decider, drawn=starts_of(task))
    return {
        "final_success": [row.success for row in rows],
        "final_ended": [row.ending for row in rows],
        "final_position_error_m": [round(row.position_error_m, 6) for row in rows],
        "final_angle_error_deg": [round(row.angle_error_deg, 5) for row in rows],
        "final_n_cycles": [row.n_cycles for row in rows],
        "final_simulated_s": [row.simulated_s for row in rows],
        "nominal_success": alone.success,
        "nominal_position_error_m": round(alone.position_error_m, 6),
        "nominal_angle_error_deg": round(alone.angle_error_deg, 5),
        "nominal_n_cycles": alone.n_cycles,
    }
