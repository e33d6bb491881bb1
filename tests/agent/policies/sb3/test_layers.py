"""The layers of an actor are found among the weights of Stable-Baselines3."""

from typing import Any, Literal

import pytest
import torch
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.utils import ConstantSchedule
from stable_baselines3.ppo import MlpPolicy as PpoPolicy
from stable_baselines3.sac import MlpPolicy as SacPolicy
from stable_baselines3.td3 import MlpPolicy as Td3Policy

from agent_proc.policies.sb3.layers import actor_layers
from agent_proc.policies.sb3.spaces import action_space, observation_space
from tests.agent.tasks import tuned

TASK = tuned()
KINDS: dict[str, type[BasePolicy]] = {"ppo": PpoPolicy, "sac": SacPolicy, "td3": Td3Policy}


@pytest.mark.parametrize("algorithm", KINDS)
def test_only_the_layers_of_the_actor_are_taken_in_their_order(algorithm: Literal["ppo", "sac", "td3"]) -> None:
    # More than ten layers, whose places have one digit or two.
    hidden = list(range(20, 31))
    arguments: dict[str, Any] = {"net_arch": hidden}
    networks = KINDS[algorithm](observation_space(TASK), action_space(TASK), ConstantSchedule(0.0), **arguments)

    layers = actor_layers(algorithm, networks.state_dict())

    assert [layer.weight.shape for layer in layers] == list(zip([*hidden, 4], [8, *hidden], strict=True))
    assert [layer.bias.shape for layer in layers] == [(n,) for n in (*hidden, 4)]


def test_later_training_does_not_change_layers_that_were_taken() -> None:
    networks = PpoPolicy(observation_space(TASK), action_space(TASK), ConstantSchedule(0.0))
    layers = actor_layers("ppo", networks.state_dict())
    before = layers[-1].bias.copy()

    with torch.no_grad():
        networks.get_parameter("action_net.bias").add_(1.0)

    assert (layers[-1].bias == before).all()
    assert (actor_layers("ppo", networks.state_dict())[-1].bias == before + 1.0).all()
