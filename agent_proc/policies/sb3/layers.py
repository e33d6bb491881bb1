"""Takes the layers of an actor out of the weights of Stable-Baselines3, which keep the critics beside them."""

import re
from collections.abc import Mapping
from typing import Any, Final, Literal

import numpy as np

from agent_proc.policies.actor import Float32s, Layer

NAMES: Final = {
    "ppo": re.compile(r"mlp_extractor\.policy_net\.(\d+)\.weight|action_net\.weight"),
    "sac": re.compile(r"actor\.latent_pi\.(\d+)\.weight|actor\.mu\.weight"),
    "td3": re.compile(r"actor\.mu\.(\d+)\.weight"),
}
"""Names of the weights of an actor; the group is the place of a layer, and the one without a place is the last."""


def actor_layers(algorithm: Literal["ppo", "sac", "td3"], weights: Mapping[str, Any]) -> tuple[Layer, ...]:
    """The layers of the actor, from the observation to the action; `weights` is the `state_dict` of a policy."""
    return tuple(
        Layer(weight=_array(weights[weight]), bias=_array(weights[bias]))
        for weight, bias in layer_names(algorithm, weights)
    )


def layer_names(algorithm: Literal["ppo", "sac", "td3"], weights: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The names of weight and bias of each layer of the actor, in their order."""
    found = [(name, match) for name in weights if (match := NAMES[algorithm].fullmatch(name))]
    found.sort(key=lambda each: int(each[1][1]) if each[1][1] is not None else len(weights))
    return [(name, name.removesuffix("weight") + "bias") for name, _ in found]


def _array(tensor: Any) -> Float32s:
    """A copy of a tensor."""
    return np.array(tensor.detach().cpu().numpy(), dtype=np.float32)
