"""Networks in NumPy: the actions of Stable-Baselines3, and equal bits whatever computes them."""

import os
import subprocess
import sys
from typing import Any, Literal

import numpy as np
import pytest
import torch
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.utils import ConstantSchedule
from stable_baselines3.ppo import MlpPolicy as PpoPolicy
from stable_baselines3.sac import MlpPolicy as SacPolicy
from stable_baselines3.td3 import MlpPolicy as Td3Policy

from agent_proc.policies.actor import Activation, Actor, Layer, Normalizer, Output
from agent_proc.policies.sb3.layers import actor_layers
from agent_proc.policies.sb3.spaces import action_space, observation_space
from agent_proc.task.action import CHOICES
from agent_proc.task.config import TaskConfig
from agent_proc.task.file import load_task
from tests.agent.policies.action_digest import digest_of_actions, observations
from tests.agent.tasks import paper

KINDS: dict[str, tuple[type[BasePolicy], Output]] = {
    "ppo": (PpoPolicy, "clip"),
    "sac": (SacPolicy, "tanh"),
    "td3": (Td3Policy, "tanh"),
}
MODULES = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU}


def pair(
    algorithm: Literal["ppo", "sac", "td3"], task: TaskConfig, activation: Activation, hidden: list[int]
) -> tuple[Actor, BasePolicy]:
    """The same random networks for both libraries; their actions are not small."""
    kind, output = KINDS[algorithm]
    torch.manual_seed(5)
    arguments: dict[str, Any] = {"net_arch": hidden, "activation_fn": MODULES[activation]}
    networks = kind(observation_space(task), action_space(task), ConstantSchedule(0.0), **arguments)
    with torch.no_grad():
        for parameter in networks.parameters():
            parameter.copy_(torch.randn_like(parameter) / max(parameter.shape) ** 0.5)
    networks.set_training_mode(False)
    discrete = task.action_form == "discrete"
    layers = actor_layers(algorithm, networks.state_dict())
    return Actor(layers, activation, "argmax" if discrete else output, CHOICES if discrete else ()), networks


@pytest.mark.parametrize("algorithm", KINDS)
@pytest.mark.parametrize("activation", MODULES)
@pytest.mark.parametrize(("name", "hidden"), [("tuned", [64, 64]), ("paper-text", [512] * 4), ("tuned", [7])])
def test_actions_are_those_of_stable_baselines3(
    algorithm: Literal["ppo", "sac", "td3"],
    activation: Activation,
    name: str,
    hidden: list[int],
) -> None:
    task = load_task(name, entry="variable")
    actor, networks = pair(algorithm, task, activation, hidden)
    seen = observations(observation_space(task).shape[0])

    done = np.array([actor.act(each) for each in seen])

    expected, _ = networks.predict(seen, deterministic=True)
    assert done.dtype == expected.dtype == np.float32
    np.testing.assert_allclose(done, expected, rtol=0.0, atol=1e-6)
    assert expected.std() > 0.1


def test_choices_are_those_of_stable_baselines3() -> None:
    task = paper(entry="fixed", action_form="discrete")
    actor, networks = pair("ppo", task, "relu", [32, 32])
    seen = observations(25)

    done = np.array([actor.act(each) for each in seen])

    expected, _ = networks.predict(seen, deterministic=True)
    np.testing.assert_array_equal(done, expected)
    assert all(len(set(column)) > 1 for column in expected.T)
    assert done[0] in action_space(task)


def test_an_observation_is_normalized_and_clipped() -> None:
    normalizer = Normalizer(mean=np.array([1.0, 0.0]), variance=np.array([4.0, 1e-8]), clip=5.0, epsilon=0.0)

    seen = normalizer.apply(np.array([2.0, 1.0], dtype=np.float32))

    assert seen.dtype == np.float32
    np.testing.assert_allclose(seen, [0.5, 5.0])


def test_the_sum_of_a_layer_adds_its_inputs_in_their_order() -> None:
    rng = np.random.default_rng(3)
    layer = Layer(weight=rng.normal(size=(5, 67)).astype(np.float32), bias=rng.normal(size=5).astype(np.float32))
    seen = rng.normal(size=67).astype(np.float32)

    done = Actor((layer,), "tanh", "tanh").act(seen)

    expected = np.zeros(5, dtype=np.float32)
    for column, value in zip(layer.weight.T, seen, strict=True):
        expected = expected + column * value
    np.testing.assert_array_equal(done, np.tanh(expected + layer.bias))
    assert not np.array_equal(expected, layer.weight.astype(np.float64) @ seen)


@pytest.mark.parametrize("kernels", ["Haswell", "Nehalem", "Zen"])
@pytest.mark.parametrize("disabled", ["", "X86_V4 AVX512_ICL AVX512_SPR"])
def test_equal_actions_with_other_kernels_of_blas_and_without_avx_512(kernels: str, disabled: str) -> None:
    environment = {**os.environ, "OPENBLAS_CORETYPE": kernels, "NPY_DISABLE_CPU_FEATURES": disabled}
    environment |= {"PYTHONPATH": os.pathsep.join(sys.path), "PYTHONWARNINGS": "ignore"}
    argv = [sys.executable, "-m", "tests.agent.policies.action_digest"]

    done = subprocess.run(argv, env=environment, check=True, capture_output=True, text=True)

    assert done.stdout.strip() == digest_of_actions()
