"""Policies as ONNX models: an ONNX runtime reads them and gives the actions of NumPy."""

import dataclasses
import json
from typing import Any

import numpy as np
import onnx
import onnxruntime
import pytest
from numpy.typing import NDArray

from agent_proc.policies.actor import Normalizer
from agent_proc.policies.folder import PolicyFolder, policy_path, read_policy, shipped_policies, widths
from agent_proc.policies.onnx_file import encode_onnx
from agent_proc.profiles.profile import load_profile
from agent_proc.task.config import TaskConfig
from agent_proc.task.observed import observation_bounds
from tests.agent.policies.policies import CARD, random_layers
from tests.agent.tasks import paper, tuned

N_OBSERVATIONS = 200


def drawn(policy: PolicyFolder) -> NDArray[np.float32]:
    """Observations within their bounds, (N_OBSERVATIONS, n), not normalized."""
    low, high = observation_bounds(policy.card.task)
    return np.random.default_rng(4).uniform(low, high, (N_OBSERVATIONS, len(low))).astype(np.float32)


def by_numpy(policy: PolicyFolder, observations: NDArray[np.float32]) -> NDArray[Any]:
    actor, normalizer = policy.actor(), policy.normalizer
    return np.array([actor.act(seen if normalizer is None else normalizer.apply(seen)) for seen in observations])


def by_runtime(model: bytes, observations: NDArray[np.float32]) -> NDArray[Any]:
    (action,) = onnxruntime.InferenceSession(model).run(["action"], {"observation": observations})
    done: NDArray[Any] = action
    return done


def made(profile: str, task: TaskConfig, normalizer: Normalizer | None) -> PolicyFolder:
    """A policy with random weights."""
    card = dataclasses.replace(CARD, task=task, profile=load_profile(profile))
    return PolicyFolder(card=card, layers=random_layers(*widths(card)), normalizer=normalizer)


@pytest.mark.parametrize("name", shipped_policies())
def test_a_shipped_policy_acts_as_in_a_mission(name: str) -> None:
    policy = read_policy(policy_path(name))
    observations = drawn(policy)

    done, expected = by_runtime(encode_onnx(policy), observations), by_numpy(policy, observations)

    assert done.dtype == expected.dtype == np.float32
    np.testing.assert_allclose(done, expected, rtol=0.0, atol=1e-6)
    assert (np.abs(expected) < 1.0).any()
    assert expected.std(axis=0).min() > 0.01


@pytest.mark.parametrize("profile", ["sac", "td3"])
def test_the_squashed_actions_of_other_algorithms_are_the_same(profile: str) -> None:
    moments = Normalizer(mean=np.linspace(-1.0, 1.0, 8), variance=np.linspace(0.1, 30.0, 8))
    policy = made(profile, tuned(entry="variable"), moments)
    observations = drawn(policy)

    done = by_runtime(encode_onnx(policy), observations)

    np.testing.assert_allclose(done, by_numpy(policy, observations), rtol=0.0, atol=1e-6)


def test_choices_are_the_same_and_integers() -> None:
    task = paper(entry="fixed", action_form="discrete")
    policy = made("tuned", task, None)
    observations = drawn(policy)

    done, expected = by_runtime(encode_onnx(policy), observations), by_numpy(policy, observations)

    assert done.dtype == expected.dtype == np.int64
    np.testing.assert_array_equal(done, expected)
    assert all(len(set(column)) > 1 for column in expected.T)


def test_one_observation_is_a_batch_of_one() -> None:
    policy = read_policy(policy_path("variable"))

    assert by_runtime(encode_onnx(policy), drawn(policy)[:1]).shape == (1, 4)


def test_the_model_has_the_card_and_equal_policies_make_equal_models() -> None:
    policy = read_policy(policy_path("variable"))
    content = encode_onnx(policy)

    (card,) = onnx.load_model_from_string(content).metadata_props

    assert card.key == "card"
    plain = json.loads(card.value)
    assert [element["name"] for element in plain["action"]] == ["w1", "w2", "leg", "depth"]
    assert plain["observation"][0]["unit"] == "m"
    assert plain["command"] == policy.card.command
    assert content == encode_onnx(policy)
