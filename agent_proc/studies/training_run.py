"""Carries a training of a study out, in a folder in which it goes on after an interruption."""

import base64
import io
import threading
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from agent_proc.learning.checkpoint import CHECKPOINT_FILE
from agent_proc.learning.plan_file import CONFIG_FILE, PROGRESS_FILE, read_plan, write_plan
from agent_proc.learning.training import Training
from agent_proc.learning.training_plan import Progress, TrainingPlan
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.policies.card import Card, Check
from legpush.errors import ConfigError
from legpush.files import write_whole
from legpush.lockstep.world import SteppingWorld
from legpush.runs.folder import own_folder


def train_in(folder: Path, plan: TrainingPlan, worlds: Sequence[SteppingWorld]) -> Check:
    """Train to the end in a folder, from its last checkpoint if it has one; returns the evaluation of the best policy.

    Raises:
        ConfigError: Another training is in the folder, another program uses it, or the training has no evaluation.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with own_folder(folder):
        begun = _begin(folder, plan)
        stop = threading.Event()
        env = PushVecEnv(plan.task, worlds, stop=stop)
        try:
            job = Training(plan, folder, env, worlds, stop=stop, on_progress=_keep_progress(folder))
            if begun:
                job.resume()
            result = job.run()
        finally:
            env.close()
    if result.best is None:
        raise ConfigError(f"Expected a training with an evaluation, got none in {result.step} steps")
    return result.best


def _begin(folder: Path, plan: TrainingPlan) -> bool:
    """Write the plan into a new folder, or see that it is there; returns whether there is a checkpoint to go on from.

    Raises:
        ConfigError: The folder has another training.
    """
    if not (folder / CONFIG_FILE).exists():
        write_plan(folder, plan)
    elif read_plan(folder) != plan:
        raise ConfigError(f"{folder}: expected the folder of this training, got one with another {CONFIG_FILE}")
    return (folder / CHECKPOINT_FILE).exists()


def _keep_progress(folder: Path) -> Callable[[Progress], None]:
    """Return what writes the share of the training that is done into its folder, whenever it grew by a hundredth."""
    before = -1

    def keep(progress: Progress) -> None:
        nonlocal before
        if (percent := min(100, 100 * progress.step // progress.steps)) > before:
            before = percent
            write_whole(folder / PROGRESS_FILE, f"{percent}\n".encode())

    return keep


def of_last(card: Card) -> dict[str, Any]:
    """Return the evaluation of the last policy, and the episodes of the training.

    Raises:
        ConfigError: The card has no evaluation.
    """
    check = card.check
    if check is None:
        raise ConfigError("Expected the evaluation of the last policy on its card, got none")
    return {
        "last_success_rate": check.success_rate,
        "last_position_error_m": check.position_error_m,
        "last_angle_error_deg": check.angle_error_deg,
        "last_falls": check.falls,
        "n_evaluated": len(check.seeds),
        "episode_step": [point.step for point in card.curve],
        "episode_return": [round(point.episode_return, 4) for point in card.curve],
        "episode_success": [point.success for point in card.curve],
        "episode_position_error_m": [round(point.position_error_m, 5) for point in card.curve],
        "episode_angle_error_deg": [round(point.angle_error_deg, 4) for point in card.curve],
    }


def pack(folder: Path) -> str:
    """Return the files of a folder as a zip file in base64."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.iterdir()):
            archive.write(file, file.name)
    return base64.b64encode(buffer.getvalue()).decode()
