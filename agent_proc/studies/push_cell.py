"""The kind of cell `push`: an episode of pushes from a seeded start, as `legpush evaluate` runs it."""

from collections.abc import Collection, Mapping
from dataclasses import asdict
from typing import Any, Final

from msgspec import Struct

from agent_proc.evaluation.episodes import run_episode
from agent_proc.studies.cell_parts import (
    STATE_CRC,
    new_simulator,
    policy_with,
    require_simulator,
    scenario_of,
    sha256_of_policy,
)
from legpush.fields import Seed
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.local import LocalWorld
from legpush.options.learning import DEFAULT_WORLD
from legpush.policy_names import DEFAULT_POLICY
from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column

COLUMNS: Final = (
    Column(name="ending", unit="", about="the policy was done, the robot fell, or the pushes were used up"),
    Column(name="success", unit="", about="whether the box ended within the tolerances and the robot stands"),
    Column(name="position_error_m", unit="m", about="distance of the box from its goal"),
    Column(name="angle_error_deg", unit="deg", about="angle of the box from its goal"),
    Column(name="n_cycles", unit="", about="number of pushes"),
    Column(name="max_abs_roll_deg", unit="deg", about="largest roll of the trunk"),
    Column(name="max_abs_pitch_deg", unit="deg", about="largest pitch of the trunk"),
    Column(name="min_support_margin_m", unit="m", about="least distance of the CoM from the border of its support"),
    STATE_CRC,
)


class PushCell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An episode as a study file sets it."""

    seed: Seed = 0
    """Seed of the offsets of robot and box."""
    scenario: str = "push"
    """A built-in scenario or the path of a scenario file, in which the robot stands ready to push."""
    policy: str = DEFAULT_POLICY
    """The policy that chooses the pushes."""
    world: str = DEFAULT_WORLD
    """The simulator: a plug-in, such as `mujoco`, `map` or `map_mean`."""
    changes: dict[str, Any] = {}
    """Other fields of the scenario, by their path. The robot stands ready for a box of another size, too."""


class ResolvedPush(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An episode that needs no other file than those of its policy."""

    seed: Seed
    scenario: Scenario
    policy: str
    policy_sha256: str
    world: str


def resolve(cell: PushCell, allowed: Collection[str]) -> ResolvedPush:
    """Load the scenario and hash the policy.

    Raises:
        ScenarioError: The scenario or a change cannot be used.
        PolicyError: The policy cannot be used.
        ConfigError: There is no such world.
    """
    require_simulator(cell.world)
    return ResolvedPush(
        seed=cell.seed,
        scenario=scenario_of(cell.scenario, cell.changes),
        policy=cell.policy,
        policy_sha256=sha256_of_policy(cell.policy, allowed),
        world=cell.world,
    )


def run(cell: ResolvedPush) -> Mapping[str, Any]:
    """Run the episode."""
    last: list[StepRecord | PlanRecord] = []

    def keep_last(record: StepRecord | PlanRecord) -> None:
        last[:] = [record]

    world = LocalWorld(new_simulator(cell.world), on_record=keep_last)
    row = asdict(run_episode(world, cell.scenario, cell.seed, policy_with(cell.policy, cell.policy_sha256)))
    crc = next(record.outcome.state_crc for record in last if isinstance(record, StepRecord))
    return {**{name: value for name, value in row.items() if name not in ("case", "seed")}, "state_crc": f"{crc:08x}"}


PUSH: Final = CellKind(
    specification=PushCell, run=run, resolved=ResolvedPush, resolve=resolve, columns=COLUMNS, changes=Scenario
)
"""The kind of cell."""
