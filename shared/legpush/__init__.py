"""A quadruped walks around obstacles to a box and pushes it to a goal pose with a front foot.

`legpush.run("default")` runs a whole mission in this process, `legpush.world("push")` opens a world to move step by
step. Everything here is imported when it is first used.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from importlib.metadata import version as _version
    from typing import Any

    from legpush.errors import (
        BrokenEpisodeError,
        ConfigError,
        LegpushError,
        MotionError,
        PluginError,
        PolicyError,
        ScenarioError,
        UnsolvableError,
    )
    from legpush.geometry import Pose2
    from legpush.in_process import MissionRun, run, world
    from legpush.messages.planning import BoxPathQuery, Plan, TrunkPathQuery
    from legpush.messages.stepping import Alter, Follow, Outcome, Push, Reset, Walk, WorldState
    from legpush.runs.report import Report
    from legpush.scenarios.file import load_scenario, scenario_names
    from legpush.scene.scenario import Box, Goal, Room, Scenario
    from legpush.stepwise import StepwiseWorld

    __version__ = _version("legpush")

__all__ = [
    "Alter",
    "Box",
    "BoxPathQuery",
    "BrokenEpisodeError",
    "ConfigError",
    "Follow",
    "Goal",
    "LegpushError",
    "MissionRun",
    "MotionError",
    "Outcome",
    "Plan",
    "PluginError",
    "PolicyError",
    "Pose2",
    "Push",
    "Report",
    "Reset",
    "Room",
    "Scenario",
    "ScenarioError",
    "StepwiseWorld",
    "TrunkPathQuery",
    "UnsolvableError",
    "Walk",
    "WorldState",
    "__version__",
    "load_scenario",
    "run",
    "scenario_names",
    "world",
]

_ADDRESSES = {
    "legpush.errors": (
        "BrokenEpisodeError",
        "ConfigError",
        "LegpushError",
        "MotionError",
        "PluginError",
        "PolicyError",
        "ScenarioError",
        "UnsolvableError",
    ),
    "legpush.geometry": ("Pose2",),
    "legpush.in_process": ("MissionRun", "run", "world"),
    "legpush.messages.planning": ("BoxPathQuery", "Plan", "TrunkPathQuery"),
    "legpush.messages.stepping": ("Alter", "Follow", "Outcome", "Push", "Reset", "Walk", "WorldState"),
    "legpush.runs.report": ("Report",),
    "legpush.scenarios.file": ("load_scenario", "scenario_names"),
    "legpush.scene.scenario": ("Box", "Goal", "Room", "Scenario"),
    "legpush.stepwise": ("StepwiseWorld",),
}


def __getattr__(name: str) -> "Any":
    from importlib import import_module

    if name == "__version__":
        from importlib.metadata import version

        value: Any = version("legpush")
    else:
        module = next((module for module, names in _ADDRESSES.items() if name in names), None)
        if module is None:
            raise AttributeError(f"module 'legpush' has no attribute {name!r}")
        value = getattr(import_module(module), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
