"""The rivals by their names."""

from collections.abc import Callable
from typing import Final, Literal

from agent_proc.policies.dynamic_programming.policy import LEAST_GAIN as LEAST_GAIN_OF_TABLE
from agent_proc.policies.dynamic_programming.policy import DynamicProgramming
from agent_proc.policies.policy import Policy
from agent_proc.policies.scripted import LEAST_GAIN
from agent_proc.rivals.best_face import BestFace, scripted_by_map, scripted_by_size
from agent_proc.rivals.blind import Action, AlternatePolicy, ConstantPolicy, RandomPolicy, zero_action
from agent_proc.rivals.lookahead import LookAhead
from agent_proc.rivals.physics import Fork, PhysicsLookAhead
from agent_proc.rivals.search import SearchPolicy
from agent_proc.rivals.steering import BangBangPolicy
from agent_proc.task.config import TaskConfig
from legpush.errors import ConfigError
from legpush.lockstep.local import LocalWorld

Rival = Literal[
    "zero",
    "random",
    "constant",
    "alternate",
    "bang_bang",
    "script",
    "script_over_map",
    "dynamic_programming",
    "look_ahead",
    "look_ahead_by_physics",
    "search",
]
RIVALS: Final[dict[Rival, Callable[[TaskConfig, Action, Fork], Policy]]] = {
    "zero": lambda task, _action, _fork: ConstantPolicy(task, zero_action(task)),
    "random": lambda task, _action, _fork: RandomPolicy(task),
    "constant": lambda task, action, _fork: ConstantPolicy(task, action),
    "alternate": lambda task, _action, _fork: AlternatePolicy(task),
    "bang_bang": lambda task, _action, _fork: BangBangPolicy(task),
    "script": lambda task, _action, _fork: BestFace(task, "script", scripted_by_size, LEAST_GAIN),
    "script_over_map": lambda task, _action, _fork: BestFace(task, "script_over_map", scripted_by_map, LEAST_GAIN),
    "dynamic_programming": lambda task, _action, _fork: BestFace(
        task,
        "dynamic_programming",
        DynamicProgramming(task.least_depth_m, task.max_depth_m).best,
        LEAST_GAIN_OF_TABLE,
    ),
    "look_ahead": lambda task, _action, _fork: LookAhead(task),
    "look_ahead_by_physics": lambda task, _action, fork: PhysicsLookAhead(task, fork),
    "search": lambda task, _action, _fork: SearchPolicy(task),
}
"""How each is made for a task; the action is that of the constant one, and the copies are for the one by physics."""
DUMBEST: Final[tuple[Rival, ...]] = ("zero", "random", "constant")
"""They take part in every comparison."""


def no_copies(_: LocalWorld | None) -> LocalWorld:
    """Copy nothing: there is no world.

    Raises:
        ConfigError: Always.
    """
    raise ConfigError("Expected a world in this process for the rival look_ahead_by_physics, which copies it")


def make_rival(name: Rival, task: TaskConfig, action: Action = (), fork: Fork = no_copies) -> Policy:
    """Make the rival with this name; `action` is that of the constant one, and `fork` copies the world.

    Raises:
        ConfigError: The action does not fit, or the rival cannot play this task.
    """
    return RIVALS[name](task, action, fork)
