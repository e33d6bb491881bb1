"""A training: learns, evaluates from time to time, keeps the best policy, and can be interrupted and resumed.

A checkpoint is captured where a rollout begins. A resumed training repeats the interrupted rollout with the same steps,
so that it ends with the same weights as an uninterrupted one.
"""

import logging
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any, Final

from stable_baselines3.common.callbacks import BaseCallback, CallbackList
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.vec_env import VecEnv

from agent_proc.learning.best_policy import build_policy, check_policy, is_better, policy_in_training
from agent_proc.learning.checkpoint import (
    CHECKPOINT_FILE,
    Checkpoint,
    CheckpointError,
    load_checkpoint,
    save_checkpoint,
)
from agent_proc.learning.films import is_due, keep_episode
from agent_proc.learning.initial_policy import begin_with
from agent_proc.learning.learner import Learner, make_learner, set_exploration, undisturbed_draws
from agent_proc.learning.learner_state import capture, restore
from agent_proc.learning.loggers.registry import make_callbacks, make_loggers
from agent_proc.learning.training_plan import Progress, TrainingPlan, TrainingResult
from agent_proc.policies.card import Check, CurvePoint
from agent_proc.policies.folder import write_policy
from agent_proc.policies.reach import Visits
from agent_proc.policies.sb3.arguments import use_one_thread
from legpush.errors import LegpushError, StopRequestedError
from legpush.lockstep.world import SteppingWorld

log = logging.getLogger(__name__)

BEST: Final = "best"
LAST: Final = "last"
WINDOW: Final = 30
"""Number of last episodes over which the shown return and success rate are means."""


class Training:
    """A training with its folder."""

    def __init__(
        self,
        plan: TrainingPlan,
        folder: Path,
        env: VecEnv,
        worlds: Sequence[SteppingWorld],
        *,
        stop: threading.Event,
        on_progress: Callable[[Progress], None] = lambda _: None,
    ) -> None:
        """Prepare a training; evaluations step `worlds`, which may be those of `env`.

        `env` has the methods `snapshot` and `restore`.
        """
        use_one_thread()
        self._plan = plan
        self._folder = folder
        self._worlds = worlds
        self._stop = stop
        self._on_progress = on_progress
        self._learner = make_learner(plan.profile, env, plan.seed)
        self._on_policy = plan.profile.algorithm == "ppo"
        self._curve: list[CurvePoint] = []
        self._checks: list[Check] = []
        self._best: Check | None = None
        self._visits = Visits()
        self._held: Checkpoint | None = None
        """The last checkpoint that was captured, whether saved or not."""
        self._saved_step = 0

    @property
    def learner(self) -> Learner:
        """The present learner."""
        return self._learner

    def resume(self) -> None:
        """Continue from the checkpoint in the folder.

        Raises:
            CheckpointError: There is none, or it cannot be used.
        """
        path = self._folder / CHECKPOINT_FILE
        held = load_checkpoint(path)
        try:
            restore(self._learner, held.learner)
        except ValueError as error:
            raise CheckpointError(f"{path}: expected a checkpoint of this training: {error}") from error
        self._curve, self._checks = list(held.curve), list(held.checks)
        self._best, self._visits = held.best, held.visits
        self._held, self._saved_step = held, held.step

    def run(self) -> TrainingResult:
        """Train to the end, or until asked to stop; the last checkpoint is saved in every case, also after an error.

        Raises:
            LegpushError: A simulator failed, a file could not be written, or the policy to begin with does not fit.
        """
        model = self._learner.model
        fresh = self._held is None
        model.set_logger(Logger(str(self._folder), make_loggers(self._plan, self._folder, model.num_timesteps)))
        try:
            return self._run(fresh=fresh)
        finally:
            model.logger.close()

    def _run(self, *, fresh: bool) -> TrainingResult:
        steps, model = self._plan.profile.steps, self._learner.model
        callbacks = make_callbacks(self._plan, self._folder)
        if fresh and self._plan.init is not None:
            self._visits = begin_with(self._learner, self._plan, self._plan.init)
        try:
            if model.num_timesteps < steps:
                model.learn(
                    steps if fresh else steps - model.num_timesteps,
                    callback=CallbackList([_Watcher(self), *callbacks]),
                    reset_num_timesteps=fresh,
                )
            ended_by = next((callback.name for callback in callbacks if callback.has_ended), None)
            if ended_by is not None or model.num_timesteps >= steps:
                self._check_if_due(last=True)
        except StopRequestedError:
            ended_by = None
        except LegpushError:
            with suppress(LegpushError):
                self._save_held()
            raise
        if not self._checks or self._checks[-1].step < (steps if ended_by is None else model.num_timesteps):
            self._save_held()
            return TrainingResult(finished=False, step=self._held.step if self._held else 0, best=self._best)
        self._write(LAST, self._checks[-1])
        self._hold()
        self._save_held()
        self._tell("done")
        return TrainingResult(finished=True, step=model.num_timesteps, best=self._best, ended_by=ended_by)

    # -- called by the algorithm ---------------------------------------------------------------------------------------

    def begin_rollout(self) -> None:
        """Evaluate and capture a checkpoint if due, and set the exploration of the next rollout."""
        if self._learner.model.num_timesteps == 0:
            self._note_views()
        self._check_if_due()
        step = self._learner.model.num_timesteps
        due = step - self._saved_step >= self._plan.profile.checkpoint_every
        if self._on_policy or due or self._held is None or self._stop.is_set():
            self._hold()
        if due:
            self._save_held()
        set_exploration(self._learner, self._plan.profile)

    def take_step(self, infos: Sequence[dict[str, Any]], dones: Sequence[bool]) -> bool:
        """Record the episodes that ended in a step of all environments; returns whether to go on."""
        self._note_views()
        step = self._learner.model.num_timesteps
        for info, done in zip(infos, dones, strict=True):
            if done:
                episode = info["episode"]
                self._curve.append(
                    CurvePoint(
                        step=step,
                        episode_return=float(episode["r"]),
                        length=int(episode["l"]),
                        success=bool(info["is_success"]),
                        position_error_m=float(info["position_error_m"]),
                        angle_error_deg=float(info["angle_error_deg"]),
                    )
                )
        self._tell("learning")
        if not self._stop.is_set():
            return True
        return not (self._on_policy or (self._held is not None and self._held.step >= step - self._plan.n_simulators))

    # -- parts ---------------------------------------------------------------------------------------------------------

    def _note_views(self) -> None:
        """Note where the boxes are about which the next decisions are made."""
        self._visits = self._visits.with_views(self._learner.env.get_attr("view"))

    def _hold(self) -> None:
        self._held = Checkpoint(
            step=self._learner.model.num_timesteps,
            learner=capture(self._learner),
            curve=tuple(self._curve),
            checks=tuple(self._checks),
            best=self._best,
            visits=self._visits,
        )

    def _save_held(self) -> None:
        if self._held is not None:
            save_checkpoint(self._folder / CHECKPOINT_FILE, self._held)
            self._saved_step = self._held.step

    def _check_if_due(self, *, last: bool = False) -> None:
        """Evaluate the policy if due, and keep it if it is the best; the state of the training does not change."""
        step, before = self._learner.model.num_timesteps, self._checks[-1].step if self._checks else 0
        if not (last and step > before) and step - before < self._plan.profile.evaluate_every:
            return
        self._hold()
        where = self._learner.env.snapshot()
        with undisturbed_draws():
            check = self._check()
            if is_due(self._plan, len(self._checks) + 1, last=step >= self._plan.profile.steps):
                self._keep_film(step)
        self._learner.env.restore(where)
        self._checks.append(check)
        log.info("step %d: %s", step, check)
        logger = self._learner.model.logger
        for name in ("success_rate", "position_error_m", "angle_error_deg", "cycles"):
            logger.record(f"evaluation/{name}", getattr(check, name))
        logger.dump(step)
        if is_better(check, self._best):
            self._best = check
            self._write(BEST, check)

    def _check(self) -> Check:
        """Evaluate the present policy."""
        n, n_done = self._plan.profile.evaluation_episodes, count()

        def tell() -> None:
            self._tell(f"evaluating, episode {next(n_done)} of {n}")

        tell()
        policy = build_policy(self._plan, self._learner, self._curve, self._visits.reach, None)
        return check_policy(policy, self._worlds, on_episode=tell, stop=self._stop)

    def _keep_film(self, step: int) -> None:
        """Keep an episode of the present policy for a film."""
        self._tell("pushing for a film")
        folder = build_policy(self._plan, self._learner, self._curve, self._visits.reach, None)
        keep_episode(self._plan, self._folder, step, policy_in_training(folder), self._worlds[0])

    def _write(self, name: str, check: Check) -> None:
        write_policy(
            self._folder / name, build_policy(self._plan, self._learner, self._curve, self._visits.reach, check)
        )

    def _tell(self, doing: str) -> None:
        recent = self._curve[-WINDOW:]
        self._on_progress(
            Progress(
                step=self._learner.model.num_timesteps,
                steps=self._plan.profile.steps,
                mean_return=sum(point.episode_return for point in recent) / len(recent) if recent else None,
                success_rate=sum(point.success for point in recent) / len(recent) if recent else None,
                best=self._best,
                doing=doing,
            )
        )


class _Watcher(BaseCallback):
    """Passes the callbacks of the algorithm on to the training."""

    def __init__(self, training: Training) -> None:
        super().__init__()
        self._training = training

    def _on_rollout_start(self) -> None:
        self._training.begin_rollout()

    def _on_step(self) -> bool:
        return self._training.take_step(self.locals["infos"], self.locals["dones"])
