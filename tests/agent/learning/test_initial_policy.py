"""A training begins with what another one learned."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import torch

from agent_proc.learning.checkpoint import load_checkpoint
from agent_proc.learning.initial_policy import begin_with
from agent_proc.learning.learner import Learner, make_learner, observation_moments
from agent_proc.learning.training import Training
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.policies.folder import read_policy
from agent_proc.policies.reach import Visits
from agent_proc.policies.sb3.layers import actor_layers
from agent_proc.task.file import load_task
from legpush.errors import PolicyError
from tests.agent.fake_world import FakeWorld
from tests.agent.learning.small_training import make_training, small_profile, weights


@pytest.fixture(scope="module", params=["tuned", "sac", "td3"])
def trained(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder of a small training, and its profile."""
    folder = tmp_path_factory.mktemp("trained")
    make_training(folder, small_profile(request.param, steps=64)).run()
    return folder, request.param


def fresh(profile_name: str, seed: int = 3) -> tuple[Learner, TrainingPlan]:
    """A new learner of the same task."""
    profile = small_profile(profile_name)
    task = load_task(profile.task)
    env = PushVecEnv(task, [FakeWorld()])
    plan = TrainingPlan(profile=profile, task=task, seed=seed, n_simulators=1, command="", versions={})
    return make_learner(profile, env, seed), plan


def test_a_policy_gives_its_actor_and_its_moments(trained: tuple[Path, str]) -> None:
    folder, name = trained
    learner, plan = fresh(name)
    policy = read_policy(folder / "last")

    assert begin_with(learner, plan, str(folder / "last")) == Visits()
    layers = actor_layers(plan.profile.algorithm, learner.model.policy.state_dict())
    for mine, theirs in zip(layers, policy.layers, strict=True):
        assert np.array_equal(mine.weight, theirs.weight)
        assert np.array_equal(mine.bias, theirs.bias)
    moments = observation_moments(learner.normalizer)
    assert moments is not None
    assert policy.normalizer is not None
    assert np.array_equal(moments[0], policy.normalizer.mean)
    assert np.array_equal(moments[1], policy.normalizer.variance)
    if name == "td3":
        target = learner.model.policy.get_submodule("actor_target").state_dict()
        for key, tensor in learner.model.policy.get_submodule("actor").state_dict().items():
            assert torch.equal(tensor, target[key])


def test_a_training_gives_its_critics_too(trained: tuple[Path, str]) -> None:
    folder, name = trained
    learner, plan = fresh(name)
    other, _ = fresh(name, seed=4)

    assert begin_with(learner, plan, str(folder)) == load_checkpoint(folder / "checkpoint").visits
    begin_with(other, plan, str(folder))
    assert weights(learner.model) == weights(other.model)
    state = load_checkpoint(folder / "checkpoint").learner
    for key, tensor in learner.model.policy.state_dict().items():
        assert tensor.numpy().tobytes() == state.weights[key].data, key
    assert learner.normalizer.ret_rms.count == state.moments["ret"].count
    assert learner.model.num_timesteps == 0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"entry": "fixed"},
            "with the action of this training, w1, w2, leg, got w1, w2, leg, depth",
        ),
        ({"mirrored": False}, "observation of this training, got one with mirrored = True in place of False"),
        (
            {"observation": {"box": {"far_m": 2.0}}},
            "that also has box_near, heading, heading_near; with box.far_m",
        ),
    ],
)
def test_a_policy_of_another_task_is_refused(trained: tuple[Path, str], changes: dict[str, Any], message: str) -> None:
    folder, name = trained
    learner, plan = fresh(name)
    task = msgspec.structs.replace(plan.task, **changes)

    with pytest.raises(PolicyError, match=message):
        begin_with(learner, replace(plan, task=task), str(folder / "last"))


def test_a_policy_of_another_algorithm_or_network_is_refused(trained: tuple[Path, str]) -> None:
    folder, name = trained
    learner, plan = fresh("sac" if name != "sac" else "tuned")

    with pytest.raises(PolicyError, match="last: expected a policy with the algorithm of this training"):
        begin_with(learner, plan, str(folder / "last"))
    with pytest.raises(PolicyError, match="expected a training with the networks of this one: at `weights`"):
        begin_with(learner, plan, str(folder))


def test_only_a_new_training_begins_with_it(trained: tuple[Path, str], tmp_path: Path) -> None:
    folder, name = trained
    profile = small_profile(name, steps=64)

    def training() -> Training:
        job = make_training(tmp_path, profile)
        job._plan = replace(job._plan, init=str(folder))
        return job

    job = training()
    before = weights(job.learner.model)
    job.run()
    assert weights(job.learner.model) != before
    again = training()
    again.resume()
    end = weights(again.learner.model)
    again.run()
    assert weights(again.learner.model) == end == weights(job.learner.model)
