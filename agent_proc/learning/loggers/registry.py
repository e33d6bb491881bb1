"""Finds loggers and callbacks of a training by name."""

from collections.abc import Callable, Collection, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import KVWriter, TensorBoardOutputFormat

from agent_proc.learning.loggers.csv_log import CsvLog
from agent_proc.learning.loggers.guarded import GuardedCallback, GuardedLog, made
from agent_proc.learning.training_plan import OWN_LOGGERS, TrainingPlan
from legpush.errors import ConfigError, PluginError
from legpush.plugins import LIBRARIES, Group, load_plugin, plugin_names

LOGGERS: Final[Group] = "legpush.loggers"
CALLBACKS: Final[Group] = "legpush.callbacks"
TENSORBOARD: Final = "tensorboard"
TENSORBOARD_RUN: Final = "run_1"
"""Folder of the events below that of the logger."""

MakeLogger = Callable[[TrainingPlan, Path, int], KVWriter]
"""Makes a logger of the folder of a training that goes on from a step; what it logged behind that is logged again."""
MakeCallback = Callable[[TrainingPlan, Path], BaseCallback]


def _tensorboard(_: TrainingPlan, folder: Path, __: int) -> KVWriter:
    return TensorBoardOutputFormat(str(folder / TENSORBOARD / TENSORBOARD_RUN))


def _csv(_: TrainingPlan, folder: Path, step: int) -> KVWriter:
    return CsvLog(folder, step)


def _wandb(plan: TrainingPlan, folder: Path, _: int) -> KVWriter:
    from agent_proc.learning.loggers.wandb_log import WandbLog

    return WandbLog(plan, folder)


BUILT_IN: Final[dict[str, MakeLogger]] = dict(zip(OWN_LOGGERS, (_tensorboard, _csv, _wandb), strict=True))
NEEDED: Final = {TENSORBOARD: "tensorboard", "wandb": "wandb"}
"""Library that a built-in logger needs."""


def require_tools(loggers: Sequence[str], callbacks: Sequence[str], allowed: Collection[str]) -> None:
    """Require loggers and callbacks that can be made; those of other packages have to be among the `allowed` ones.

    Raises:
        ConfigError: There is none of this name, a library is missing, or one runs code and was not allowed.
        PluginError: One of another package cannot be imported, or makes nothing.
    """
    for names, group, flag, own in (
        (loggers, LOGGERS, "--loggers", tuple(BUILT_IN)),
        (callbacks, CALLBACKS, "--callbacks", ()),
    ):
        if len(set(names)) < len(names):
            raise ConfigError(f"Expected each name once for {flag}, got {', '.join(names)}")
        valid = (*own, *plugin_names(group))
        for name in names:
            if name not in valid:
                known = ", ".join(valid) or "none is installed"
                raise ConfigError(f"Expected installed names for {flag} ({known}), got {name!r}")
            if name not in own and name not in allowed:
                raise ConfigError(f"{name} is of another package and runs code: repeat it with {flag} {name}")
            _require_library(name, flag)
            if name not in own and not callable(load_plugin(group, name)):
                raise PluginError(f"Expected a class or a function for {flag}, got {name!r}, which cannot be called")


def make_loggers(plan: TrainingPlan, folder: Path, step: int) -> list[KVWriter]:
    """Make the loggers of a training that goes on from a step.

    Raises:
        PluginError: One of another package cannot be imported, or what makes it fails.
    """
    return [_logger(name, plan, folder, step) for name in plan.loggers]


def make_callbacks(plan: TrainingPlan, folder: Path) -> list[GuardedCallback]:
    """Make the callbacks of a training.

    Raises:
        PluginError: One cannot be imported, or what makes it fails.
    """
    makers: list[MakeCallback] = [load_plugin(CALLBACKS, name) for name in plan.callbacks]
    return [
        GuardedCallback(made(make, BaseCallback, f"callback {name!r}", plan, folder), name)
        for name, make in zip(plan.callbacks, makers, strict=True)
    ]


def _logger(name: str, plan: TrainingPlan, folder: Path, step: int) -> KVWriter:
    if name in BUILT_IN:
        return BUILT_IN[name](plan, folder, step)
    make: MakeLogger = load_plugin(LOGGERS, name)
    return GuardedLog(made(make, KVWriter, f"logger {name!r}", plan, folder, step), name)


def _require_library(name: str, flag: str) -> None:
    library = NEEDED.get(name)
    if library is not None and find_spec(library) is None:
        raise ConfigError(
            f"{flag} {name} needs {library}, which is not installed; pip install 'legpush[{LIBRARIES[library]}]' "
            "installs it"
        )
