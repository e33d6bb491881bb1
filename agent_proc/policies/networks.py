"""The networks of a policy, as its training profile describes them."""

from typing import Any, Final

import torch

from agent_proc.profiles.profile import AnyProfile, PpoProfile

ACTIVATIONS: Final = {"relu": torch.nn.ReLU, "tanh": torch.nn.Tanh}


def use_one_thread() -> None:
    """Networks are small: more threads only get in each other's way, and change the order of sums."""
    torch.set_num_threads(1)


def policy_arguments(profile: AnyProfile) -> dict[str, Any]:
    """What the networks of a profile are built with."""
    network = profile.network
    arguments: dict[str, Any] = {
        "net_arch": list(network.hidden),
        "activation_fn": ACTIVATIONS[network.activation],
    }
    if isinstance(profile, PpoProfile):
        arguments["log_std_init"] = profile.settings.log_std_init
    return arguments
