"""Makes the environment `legpush/Push-v1` from plain data, such as names, numbers and lists."""

from dataclasses import fields, replace
from typing import Any, cast

import msgspec

from agent_proc.learning.env import PushEnv
from agent_proc.task.config import Domain, TaskConfig
from legpush.errors import ConfigError
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.simulator import Stepper
from legpush.lockstep.world import SteppingWorld
from legpush.numerics.current import tell_if_native
from legpush.plugins import load_plugin
from legpush.scenarios.file import load_scenario

DOMAIN = tuple(field.name for field in fields(Domain))
TASK = tuple(field.name for field in fields(TaskConfig) if field.name not in ("scenario", "domain"))


def make_push_env(
    task: TaskConfig | None = None,
    world: SteppingWorld | None = None,
    *,
    scenario: str = "push",
    simulator: str = "mujoco",
    render_mode: None = None,
    **settings: Any,
) -> PushEnv:
    """Make an environment with a simulator of its own.

    Args:
        task: The whole task; if None, `scenario` and `settings` define it.
        world: A simulator to step, in this process or on the bus; if None, the environment makes its own.
        scenario: The name of a built-in scenario, or the path of a scenario file.
        simulator: The plug-in that simulates (`legpush.simulators`).
        render_mode: None, as the environment does not render.
        settings: Fields of `TaskConfig`, such as `entry="fixed"` or `max_steps=50`, and intervals of its domain, such
            as `mass_kg=[0.1, 1.0]`, drawn for every episode.

    Raises:
        ConfigError: A setting is unknown or cannot be used, or another environment uses the simulator.
        ScenarioError: The scenario cannot be used.
        PluginError: The simulator cannot be found.
        TypeError: A render mode was given. Stable-Baselines3 tries one first, and expects this error.
    """
    if render_mode is not None:
        raise TypeError(f"got an unexpected keyword argument 'render_mode' ({render_mode!r}): there is no rendering")
    if world is None:
        tell_if_native()
        world = LocalWorld(cast(Stepper, load_plugin("legpush.simulators", simulator)()))
    if task is None:
        return PushEnv(_task(scenario, settings), world)
    if settings:
        raise ConfigError(f"Expected either a task or its settings, got both: {', '.join(settings)}")
    return PushEnv(task, world)


def _task(scenario: str, settings: dict[str, Any]) -> TaskConfig:
    unknown = settings.keys() - {*TASK, *DOMAIN}
    if unknown:
        raise ConfigError(f"Expected settings among {', '.join((*TASK, *DOMAIN))}, got {', '.join(sorted(unknown))}")
    plain = {name: value for name, value in settings.items() if name in TASK}
    domain = {name: value for name, value in settings.items() if name in DOMAIN}
    try:
        config = msgspec.convert({**plain, "domain": domain}, TaskConfig)
    except msgspec.ValidationError as error:
        raise ConfigError(f"A setting of the environment cannot be used: {error}") from error
    return replace(config, scenario=load_scenario(scenario))
