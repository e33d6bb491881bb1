"""The kind of cell that pushes without learning: every push is the same, but for its leg, which a rule chooses."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict
from itertools import count
from typing import Any, Final, Literal

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from agent_proc.evaluation.episodes import run_episode
from agent_proc.frames.push_view import PushView
from agent_proc.studies.cell_parts import new_simulator, require_simulator
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from agent_proc.task.file import load_task
from legpush.fields import Seed
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Push
from legpush.options.learning import DEFAULT_WORLD
from legpush.realism.settings import Randomization
from legpush.scene.conventions import FRONT_LEGS, FrontLeg
from legpush.study.cells import CellKind, Column

Rule = Literal["left", "right", "left_mirrored", "right_mirrored", "alternate", "random", "steering"]
MIDDLE: Final = 0.5
"""Of w1 and w2."""
MAX_CYCLES: Final = 60
"""Pushes after which an episode ends: twice as many as 1 m takes."""
COLUMNS: Final = (
    Column(name="how", unit="", about="the rules of the task ended it (`done`), or `fell`, `astray` or `max_cycles`"),
    Column(name="success", unit="", about="whether it was done with the box within the tolerances"),
    Column(name="position_error_m", unit="m", about="distance of the box from its goal"),
    Column(name="angle_error_deg", unit="deg", about="angle of the box from its goal"),
    Column(name="n_cycles", unit="", about="number of pushes"),
)


class LegRule(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An episode as a study file sets it."""

    rule: Rule
    """Always the same leg, the same but the other one on the right of the line through the goal, one after the other, a
    random one, or the one that the steering error asks for: the left leg if the box has to turn to the right."""
    seed: Seed
    """Seed of the start and of random legs."""
    ending: str = "release"
    """The task whose rules end the episode."""
    starts: Literal["scenario", "one"] = "scenario"
    """Starts with the offsets of the scenario, or the one without offsets."""
    world: str = DEFAULT_WORLD
    """The simulator: a plug-in, such as `mujoco` or `map`."""


class ResolvedRule(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An episode that needs no other file."""

    rule: Rule
    seed: Seed
    task: TaskConfig
    world: str


def resolve(cell: LegRule, _: Collection[str]) -> ResolvedRule:
    """Load the task.

    Raises:
        ConfigError: There is no such task or world.
    """
    require_simulator(cell.world)
    task = load_task(cell.ending)
    scenario = task.scenario
    if cell.starts == "one":
        scenario = replace(scenario, randomization=Randomization())
    scenario = replace(scenario, mission=replace(scenario.mission, max_push_cycles=MAX_CYCLES))
    return ResolvedRule(rule=cell.rule, seed=cell.seed, task=replace(task, scenario=scenario), world=cell.world)


class Blind:
    """Pushes with the leg of a rule until the rules of a task end the episode."""

    def __init__(self, rule: Rule, task: TaskConfig, seed: int) -> None:
        """Begin an episode."""
        self._leg = _leg_of(rule, seed)
        self._task = task

    def decide(self, view: PushView) -> Push | None:
        """Choose the next push."""
        if has_arrived(self._task, view):
            return None
        return Push(w1=MIDDLE, w2=MIDDLE, leg=self._leg(view), depth_m=self._task.fixed_depth_m)


def _leg_of(rule: Rule, seed: int) -> Callable[[PushView], FrontLeg]:
    """Return what chooses the leg of each push of an episode."""
    left, right = FRONT_LEGS
    n_pushes, rng = count(), np.random.default_rng(seed)
    rules: dict[Rule, Callable[[PushView], FrontLeg]] = {
        "left": lambda _: left,
        "right": lambda _: right,
        "left_mirrored": lambda view: left if view.mirror_sign > 0.0 else right,
        "right_mirrored": lambda view: right if view.mirror_sign > 0.0 else left,
        "alternate": lambda _: FRONT_LEGS[next(n_pushes) % 2],
        "random": lambda _: FRONT_LEGS[int(rng.integers(2))],
        "steering": lambda view: left if view.steering_error_rad > 0.0 else right,
    }
    return rules[rule]


def run(cell: ResolvedRule) -> Mapping[str, Any]:
    """Run the episode."""
    world = LocalWorld(new_simulator(cell.world))
    row = asdict(run_episode(world, cell.task.scenario, cell.seed, Blind(cell.rule, cell.task, cell.seed)))
    names = ("success", "position_error_m", "angle_error_deg", "n_cycles")
    return {"how": row["ending"], **{name: row[name] for name in names}}


LEG_RULE: Final = CellKind(specification=LegRule, run=run, resolved=ResolvedRule, resolve=resolve, columns=COLUMNS)
"""The kind of cell."""
