"""The kind of cell `push`: an episode of pushes from a seeded start, as `legpush evaluate` runs it."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict
from pathlib import Path
from time import thread_time
from typing import Any, Final, cast

from msgspec import Struct
from msgspec.structs import replace

from agent_proc.evaluation.episodes import run_episode
from agent_proc.frames.push_view import PushView
from agent_proc.policies.folder import read_card
from agent_proc.policies.policy import Policy
from agent_proc.rivals.registry import RIVALS, Rival, make_rival
from agent_proc.studies.cell_parts import (
    STATE_CRC,
    new_simulator,
    policy_with,
    require_simulator,
    scenario_of,
    sha256_of_policy,
)
from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import scenario_of_start
from agent_proc.task.file import DEFAULT_TASK, load_task
from agent_proc.task.worlds import require_known
from legpush.errors import ConfigError
from legpush.fields import Seed
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Push
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
    Column(name="simulated_s", unit="s", about="simulated time of the episode"),
    Column(name="max_abs_roll_deg", unit="deg", about="largest roll of the trunk"),
    Column(name="max_abs_pitch_deg", unit="deg", about="largest pitch of the trunk"),
    Column(name="min_support_margin_m", unit="m", about="least distance of the CoM from the border of its support"),
    Column(name="decision_cpu_s", unit="s", about="mean time of the processor for a decision", may_differ=True),
    STATE_CRC,
)


class PushCell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An episode as a study file sets it."""

    seed: Seed = 0
    """Seed of the offsets of robot and box."""
    scenario: str = "push"
    """A built-in scenario or the path of a scenario file, in which the robot stands ready to push."""
    policy: str = DEFAULT_POLICY
    """The policy that chooses the pushes, or a rival of one: `zero`, `random` or `constant`."""
    task: str = DEFAULT_TASK
    """Task whose actions and stop rule a rival has: a built-in one, the path of a task file, or the folder of a
    policy."""
    action: tuple[float, ...] = ()
    """Action of the rival `constant`: w1, w2 and leg in [-1, 1], and with variable entry the depth; of discrete actions
    the indices."""
    domain: str | None = None
    """Task, built in or a file, whose domain, tolerances and most push cycles replace those of the scenario: each seed
    draws its own box and goal."""
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
    """Empty for a rival."""
    task: TaskConfig | None
    """Of a rival."""
    action: tuple[float, ...]
    world: str


def resolve(cell: PushCell, allowed: Collection[str]) -> ResolvedPush:
    """Load the scenario and hash the policy.

    Raises:
        ScenarioError: The scenario or a change cannot be used.
        PolicyError: The policy cannot be used.
        ConfigError: There is no such world.
    """
    require_simulator(cell.world)

    def in_scenario(name: str) -> Scenario:
        return drawn_start(scenario_of(name, cell.changes), cell.domain, cell.seed)

    scenario = in_scenario(cell.scenario)
    require_known(cell.world, lambda name: [scenario if name is None else in_scenario(name)], "world", "scenario")
    is_rival = cell.policy in RIVALS
    if cell.action and cell.policy != "constant":
        raise ConfigError(f"Expected an action with the policy `constant` alone, got one with {cell.policy}")
    task = task_of(cell.task, scenario) if is_rival else None
    if task is not None:
        make_rival(cast(Rival, cell.policy), task, cell.action)
    return ResolvedPush(
        seed=cell.seed,
        scenario=scenario,
        policy=cell.policy,
        policy_sha256="" if is_rival else sha256_of_policy(cell.policy, allowed),
        task=task,
        action=cell.action,
        world=cell.world,
    )


def drawn_start(scenario: Scenario, domain: str | None, seed: int) -> Scenario:
    """The scenario of a start: with what its seed draws from the domain of a task, its tolerances and its steps.

    Raises:
        ConfigError: There is no such task.
    """
    if domain is None:
        return scenario
    return scenario_of_start(load_task(domain, scenario), seed)


def task_of(name: str, scenario: Scenario) -> TaskConfig:
    """The task that a cell names, in a scenario.

    Raises:
        ConfigError: There is none.
        PolicyError: The card of the policy cannot be used.
    """
    folder = Path(name)
    return replace(read_card(folder).task, scenario=scenario) if folder.is_dir() else load_task(name, scenario)


def run(cell: ResolvedPush) -> Mapping[str, Any]:
    """Run the episode."""
    last: list[StepRecord | PlanRecord] = []

    def keep_last(record: StepRecord | PlanRecord) -> None:
        last[:] = [record]

    world = LocalWorld(new_simulator(cell.world), on_record=keep_last)
    policy = Timed(_policy(cell, lambda of: (of or world).fork()))
    row = asdict(run_episode(world, cell.scenario, cell.seed, policy))
    outcome = next(record.outcome for record in last if isinstance(record, StepRecord))
    return {
        **{name: value for name, value in row.items() if name not in ("case", "seed")},
        "decision_cpu_s": policy.cpu_s / policy.n,
        "state_crc": f"{outcome.state_crc:08x}",
    }


def _policy(cell: ResolvedPush, fork: Callable[[LocalWorld | None], LocalWorld]) -> Policy:
    if cell.task is None:
        return policy_with(cell.policy, cell.policy_sha256)
    return make_rival(cast(Rival, cell.policy), cell.task, cell.action, fork)


class Timed:
    """A policy whose decisions are counted and timed."""

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.n = 0
        self.cpu_s = 0.0

    def decide(self, view: PushView) -> Push | None:
        """Decide as without it."""
        began_s = thread_time()
        push = self._policy.decide(view)
        self.cpu_s += thread_time() - began_s
        self.n += 1
        return push


PUSH: Final = CellKind(
    specification=PushCell, run=run, resolved=ResolvedPush, resolve=resolve, columns=COLUMNS, changes=Scenario
)
"""The kind of cell."""
