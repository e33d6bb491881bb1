"""Small trainings in a world without physics."""

import threading
from collections.abc import Callable
from pathlib import Path

from msgspec.structs import replace
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.logger import Logger

from agent_proc.learning.learner import Learner, make_learner
from agent_proc.learning.training import Training
from agent_proc.learning.training_plan import Progress, TrainingPlan
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.profiles.profile import AnyProfile, OffPolicySettings, PpoSettings, load_profile
from agent_proc.task.file import load_task
from tests.agent.fake_world import FakeWorld, scenario_at_station

N_WORLDS = 2


def small_profile(name: str = "tuned", **changes: int) -> AnyProfile:
    """A profile with tiny networks and frequent updates."""
    profile = load_profile(name)
    settings = profile.settings
    if isinstance(settings, PpoSettings):
        settings = replace(settings, n_steps=16, batch_size=16, n_epochs=2)
    elif isinstance(settings, OffPolicySettings):
        settings = replace(settings, learning_starts=20, batch_size=8, buffer_size=500)
    fields = {"steps": 160, "evaluate_every": 64, "evaluation_episodes": 2, "checkpoint_every": 32, **changes}
    small: AnyProfile = replace(profile, settings=settings, network=replace(profile.network, hidden=(8, 8)), **fields)
    return small


def make_training(
    folder: Path,
    profile: AnyProfile,
    *,
    on_progress: Callable[[Progress], None] = lambda _: None,
    stop: threading.Event | None = None,
) -> Training:
    """A training of the profile in a folder, pushing a box 1 m."""
    scenario = scenario_at_station()
    scenario = replace(scenario, mission=replace(scenario.mission, max_push_cycles=12))
    task = load_task(profile.task, scenario, max_steps=12)
    worlds = [FakeWorld(box_offset=(0.0, 0.03, 0.02)) for _ in range(N_WORLDS)]
    plan = TrainingPlan(profile=profile, task=task, seed=7, n_simulators=N_WORLDS, command="legpush train", versions={})
    env = PushVecEnv(task, worlds)
    return Training(plan, folder, env, worlds, stop=stop or threading.Event(), on_progress=on_progress)


def learned(profile: AnyProfile, env: PushVecEnv, n_steps: int, learner: Learner | None = None) -> Learner:
    """A learner after some steps."""
    learner = learner or make_learner(profile, env, 3)
    learner.model.set_logger(Logger(None, []))  # the one by default makes a folder among the temporary ones
    learner.model.learn(n_steps, reset_num_timesteps=learner.model.num_timesteps == 0)
    return learner


def weights(model: BaseAlgorithm) -> bytes:
    """All that was learned."""
    return b"".join(tensor.numpy().tobytes() for tensor in model.policy.state_dict().values())
