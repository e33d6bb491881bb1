"""Makes the environment `legpush/Push-v1` from plain data, such as names, numbers and lists."""

from typing import Any, Final, cast

from agent_proc.learning.env import PushEnv
from agent_proc.learning.rendering import FRAME_SIZE, RenderMode
from agent_proc.task.config import TaskConfig
from agent_proc.task.domain import DOMAIN_FIELDS
from agent_proc.task.file import DEFAULT_TASK, load_task
from legpush.errors import ConfigError
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.simulator import Stepper
from legpush.lockstep.world import SteppingWorld
from legpush.numerics.current import tell_if_native
from legpush.plugins import load_plugin
from legpush.scenarios.file import load_scenario

TASK_FIELDS: Final = tuple(name for name in TaskConfig.__struct_fields__ if name not in ("scenario", "domain"))


def make_push_env(
    task: TaskConfig | str = DEFAULT_TASK,
    world: SteppingWorld | None = None,
    *,
    scenario: str | None = None,
    simulator: str = "mujoco",
    render_mode: RenderMode | None = None,
    width: int = FRAME_SIZE[0],
    height: int = FRAME_SIZE[1],
    **settings: Any,
) -> PushEnv:
    """Make an environment with a simulator of its own.

    Args:
        task: The name of a built-in task or the path of a task file, in which `scenario` and `settings` replace values;
            or a whole task.
        world: A simulator to step, in this process or on the bus; if None, the environment makes its own.
        scenario: The name of a built-in scenario, or the path of a scenario file; if None, that of the task.
        simulator: The plug-in that simulates (`legpush.simulators`).
        render_mode: `rgb_array` lets `render` return pictures, `human` shows them in a window of pygame.
        width: Width of a picture in pixels.
        height: Height of a picture in pixels.
        settings: Fields of `TaskConfig`, such as `entry="fixed"` or `max_steps=50`, and of its domain, such as
            `mass_kg=[0.1, 1.0]`, drawn for every episode.

    Raises:
        ConfigError: A setting is unknown or cannot be used, or another environment uses the simulator.
        ScenarioError: The scenario cannot be used.
        PluginError: The simulator cannot be found.
    """
    if world is None:
        tell_if_native()
        world = LocalWorld(cast(Stepper, load_plugin("legpush.simulators", simulator)()))
    return PushEnv(task_with(task, scenario, settings), world, render_mode, (width, height))


def task_with(task: TaskConfig | str, scenario: str | None, settings: dict[str, Any]) -> TaskConfig:
    """The task, with a scenario and settings that replace its own.

    Raises:
        ConfigError: A setting is unknown or cannot be used, or there are some for a whole task.
        ScenarioError: The scenario cannot be used.
    """
    if isinstance(task, TaskConfig):
        if settings or scenario is not None:
            given = [*settings, *(["scenario"] if scenario is not None else [])]
            raise ConfigError(f"Expected either a whole task or settings of one, got both: {', '.join(given)}")
        return task
    valid = (*TASK_FIELDS, *DOMAIN_FIELDS)
    if unknown := sorted(settings.keys() - {*valid}):
        raise ConfigError(f"Expected settings among {', '.join(valid)}, got {', '.join(unknown)}")
    plain = {field: value for field, value in settings.items() if field in TASK_FIELDS}
    domain = {field: value for field, value in settings.items() if field in DOMAIN_FIELDS}
    loaded = None if scenario is None else load_scenario(scenario)
    return load_task(task, loaded, **plain, domain=domain)
