"""Makes the environment `legpush/PushL4-v2` from plain data, such as names, numbers and lists."""

from typing import Any, Final, cast

from msgspec import UNSET
from msgspec.structs import replace

from agent_proc.learning.make_env import task_with
from agent_proc.learning.rendering import FRAME_SIZE, RenderMode
from agent_proc.mission_env.env import MissionEnv
from agent_proc.task.config import TaskConfig
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.simulator import Stepper
from legpush.lockstep.world import World
from legpush.numerics.current import tell_if_native
from legpush.plans.planner import MakePlans
from legpush.plugins import load_plugin

DEFAULT_TASK: Final = "push-l4"


def make_mission_env(
    task: TaskConfig | str = DEFAULT_TASK,
    world: World | None = None,
    *,
    scenario: str | None = None,
    simulator: str = "mujoco",
    planner: str = "ompl",
    render_mode: RenderMode | None = None,
    width: int = FRAME_SIZE[0],
    height: int = FRAME_SIZE[1],
    **settings: Any,
) -> MissionEnv:
    """Make an environment with a simulator and a planner of its own.

    Args:
        task: The name of a built-in task or the path of a task file, in which `scenario` and `settings` replace values;
            or a whole task.
        world: A simulator and a planner, in this process or on the bus; if None, the environment makes its own.
        scenario: The name of a built-in scenario, or the path of a scenario file, in which all missions take place; if
            None, each episode draws a room if the task does, or takes place in the scenario of the task.
        simulator: The plug-in that simulates (`legpush.simulators`).
        planner: The plug-in that plans (`legpush.planners`).
        render_mode: `rgb_array` lets `render` return pictures, `human` shows them in a window of pygame.
        width: Width of a picture in pixels.
        height: Height of a picture in pixels.
        settings: Fields of `TaskConfig`, such as `random_room={"obstacles": 4}` or `max_steps=50`, and of its domain,
            such as `mass_kg=[0.1, 1.0]`, drawn for every episode.

    Raises:
        ConfigError: A setting is unknown or cannot be used, or another environment uses the simulator.
        ScenarioError: The scenario cannot be used.
        PluginError: The simulator or the planner cannot be found.
    """
    if world is None:
        tell_if_native()
        make_plans = cast(MakePlans, load_plugin("legpush.planners", planner))
        world = LocalWorld(cast(Stepper, load_plugin("legpush.simulators", simulator)()), make_plans)
    made = task_with(task, scenario, settings)
    if scenario is not None and "random_room" not in settings:
        made = replace(made, random_room=UNSET)
    return MissionEnv(made, world, render_mode, (width, height))
