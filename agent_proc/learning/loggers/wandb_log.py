"""Logs a training as a run of Weights & Biases: into its folder, without a network, if WANDB_MODE says nothing else."""

import os
from pathlib import Path
from typing import Any, Final

import msgspec
import wandb
from stable_baselines3.common.logger import KVWriter

from agent_proc.learning.training_plan import TrainingPlan
from legpush.files import make_folder

PROJECT: Final = "legpush"
OFFLINE: Final = "offline"


class WandbLog(KVWriter):
    """A run in the folder `wandb` of a training; a training that goes on is a further run of the same group.

    `wandb sync FOLDER/wandb/offline-run-*` sends it. Neither code nor facts about the machine are kept.
    """

    def __init__(self, plan: TrainingPlan, folder: Path) -> None:
        self._folder = folder
        name = folder.resolve().name
        make_folder(folder / "wandb", private=True)
        self._run = wandb.init(
            project=os.environ.get("WANDB_PROJECT", PROJECT),
            dir=str(folder),
            mode=os.environ.get("WANDB_MODE", OFFLINE),  # type: ignore[arg-type]
            name=name,
            group=name,
            config=msgspec.to_builtins(plan),
            reinit="create_new",
            settings=wandb.Settings(
                symlink=False,
                silent=True,
                console="off",
                disable_git=True,
                disable_code=True,
                x_disable_stats=True,
                x_disable_meta=True,
                x_disable_machine_info=True,
            ),
        )

        self._remove_links(folder)

    @staticmethod
    def _remove_links(folder: Path) -> None:
        """Remove links to files elsewhere: the folder of a training has none, so that it can go on in it."""
        for path in (folder / "wandb").rglob("*"):
            if path.is_symlink():
                path.unlink()

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        """Log the numbers."""
        numbers = {key: value for key, value in key_values.items() if isinstance(value, bool | int | float)}
        numbers |= {key: value.item() for key, value in key_values.items() if getattr(value, "ndim", 1) == 0}
        self._run.log({**numbers, "step": step})

    def close(self) -> None:
        """End the run."""
        self._run.finish()
        self._remove_links(self._folder)
