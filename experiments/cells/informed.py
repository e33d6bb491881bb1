"""The kind of cell of an oracle: dynamic programming that has pushed this very box before its episode begins.

What the box does is measured from the start of the episode, over and over, and the episode begins with that estimate.
So the difference from dynamic programming is the price of not knowing the box. A start from which it succeeds can be
solved.
"""

from collections.abc import Collection, Mapping
from dataclasses import asdict
from itertools import product
from typing import Annotated, Any, Final

from msgspec import Meta, Struct

from agent_proc.evaluation.episodes import run_episode
from agent_proc.policies.dynamic_programming.policy import DynamicProgramming
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.studies.cell_parts import new_simulator
from agent_proc.studies.push_cell import Timed
from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import scenario_of_start
from agent_proc.task.file import load_task
from legpush.errors import MotionError
from legpush.fields import Seed
from legpush.lockstep.local import LocalWorld
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column

POLICY: Final = "informed"
DEPTHS_M: Final = (0.02, 0.05, 0.08, 0.1)
USUAL: Final = 0.5
"""w1 and w2 of every push of dynamic programming."""
COLUMNS: Final = (
    Column(name="policy", unit="", about="always the same: this oracle"),
    Column(name="n_known", unit="", about="pushes by which the box was known"),
    Column(name="ending", unit="", about="`done`, `fell`, `astray`, `refused` or `max_cycles`"),
    Column(name="success", unit="", about="whether it was done, within the tolerances"),
    Column(name="position_error_m", unit="m", about="at the end"),
    Column(name="angle_error_deg", unit="deg", about="at the end"),
    Column(name="n_cycles", unit="", about="number of pushes"),
    Column(name="simulated_s", unit="s", about="simulated time of the episode"),
    Column(name="decision_cpu_s", unit="s", about="mean CPU time of a decision", may_differ=True),
)


class Informed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A start as a study file sets it."""

    task: str
    seed: Seed = 0
    n_series: Annotated[int, Meta(ge=1, le=20)] = 4
    """Series of pushes from the start: one of each depth with each leg, in turn."""


class ResolvedInformed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A start that needs no other file."""

    task: TaskConfig
    seed: Seed
    n_series: int


def resolve(cell: Informed, _: Collection[str]) -> ResolvedInformed:
    """Load the task.

    Raises:
        ConfigError: There is no such task.
    """
    return ResolvedInformed(task=load_task(cell.task), seed=cell.seed, n_series=cell.n_series)


def run(cell: ResolvedInformed) -> Mapping[str, Any]:
    """Get to know the box, then push it to its goal."""
    scenario, world = scenario_of_start(cell.task, cell.seed), LocalWorld(new_simulator())
    estimate = PushEstimate(scenario.box)
    n_known = sum(_learn(estimate, world, scenario, cell.seed) for _ in range(cell.n_series))
    policy = Timed(DynamicProgramming())
    row = asdict(run_episode(world, scenario, cell.seed, policy, known={"rear": estimate}))
    return {
        "policy": POLICY,
        "n_known": n_known,
        **{column.name: row[column.name] for column in COLUMNS[2:-1]},
        "decision_cpu_s": policy.cpu_s / policy.n,
    }


def _learn(estimate: PushEstimate, world: LocalWorld, scenario: Scenario, seed: int) -> int:
    """Push from the start with each depth and leg; returns the number of pushes, up to one that is refused."""
    outcome, n_pushes = world.step(Reset(scenario=scenario, seed=seed)), 0
    for depth_m, leg in product(DEPTHS_M, FRONT_LEGS):
        push, before = Push(w1=USUAL, w2=USUAL, leg=leg, depth_m=depth_m), planar_pose(as_seen(outcome.world).box)
        try:
            outcome = world.step(push)
        except MotionError:
            break
        estimate.learn(before, push, planar_pose(as_seen(outcome.world).box))
        n_pushes += 1
    return n_pushes


INFORMED: Final = CellKind(specification=Informed, run=run, resolved=ResolvedInformed, resolve=resolve, columns=COLUMNS)
"""The kind of cell."""
