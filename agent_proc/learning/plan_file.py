"""The plan of a training as the file `config.json` in its folder."""

from pathlib import Path
from typing import Any, Final

import msgspec

from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.policies.alike import require_alike
from agent_proc.policies.folder import read_card, trained_path
from agent_proc.profiles.profile import AnyProfile, read_profile
from agent_proc.task.config import TaskConfig
from agent_proc.task.file import read_task
from legpush.errors import ConfigError
from legpush.files import write_whole

CONFIG_FILE: Final = "config.json"
PROGRESS_FILE: Final = "progress"
"""In the folder of a training that is a cell of a study: how much of it is done, in hundredths."""
_PLAN_FIELDS: Final[dict[str, Any]] = {
    "seed": int,
    "n_simulators": int,
    "command": str,
    "versions": dict[str, str],
}
"""Types of all fields but the profile and the task, which have readers of their own."""
_LATER_FIELDS: Final[dict[str, Any]] = {
    "world": str,
    "init": str | None,
    "loggers": tuple[str, ...],
    "callbacks": tuple[str, ...],
    "film_every": int | None,
    "film_last": bool,
}
"""Types of the fields that plans of earlier versions do not have."""


def write_plan(folder: Path, plan: TrainingPlan) -> None:
    """Write the plan of a training that begins in the folder.

    Raises:
        DiskError: It cannot be written.
    """
    text = msgspec.json.format(msgspec.json.encode(plan), indent=1) + b"\n"
    write_whole(folder / CONFIG_FILE, text, private=True)


def read_plan(folder: Path) -> TrainingPlan:
    """Read the plan of a training from its folder.

    Raises:
        ConfigError: It is not the folder of a training.
    """
    path = folder / CONFIG_FILE
    try:
        plain: dict[str, Any] = msgspec.json.decode(path.read_bytes(), type=dict)
        profile = read_profile(plain["profile"], f"{path}: profile")
        task = read_task(plain["task"], f"{path}: task")
        rest = {name: msgspec.convert(plain[name], kind) for name, kind in _PLAN_FIELDS.items()}
        rest |= {name: msgspec.convert(plain[name], kind) for name, kind in _LATER_FIELDS.items() if name in plain}
    except (OSError, msgspec.MsgspecError, KeyError, RecursionError) as error:
        raise ConfigError(f"Expected the folder of a training for --resume: {path} ({error})") from error
    return TrainingPlan(profile=profile, task=task, **rest)


def require_initial(profile: AnyProfile, task: TaskConfig, init: str) -> None:
    """Require a policy, or the folder of a training, that a training with this profile on this task can begin with.

    Raises:
        PolicyError: There is none, or it is one of another algorithm, network, observation or action; says in what.
    """
    folder = trained_path(init)
    if not (folder / CONFIG_FILE).is_file():
        require_alike(profile, task, read_card(folder), init)
