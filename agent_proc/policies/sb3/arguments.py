"""Arguments with which Stable-Baselines3 builds the networks of a training profile."""

from typing import Any, Final

import torch

from agent_proc.profiles.profile import AnyProfile, PpoProfile

ACTIVATIONS: Final = {"relu": torch.nn.ReLU, "tanh": torch.nn.Tanh}


def use_one_thread() -> None:
    """Use one thread: the networks are too small to gain from more, and the order of sums must not change."""
    torch.set_num_threads(1)


def policy_arguments(profile: AnyProfile) -> dict[str, Any]:
    """Arguments with which Stable-Baselines3 builds the networks of a profile."""
    network = profile.network
    arguments: dict[str, Any] = {
        "net_arch": list(network.hidden),
        "activation_fn": ACTIVATIONS[network.activation],
    }
    if isinstance(profile, PpoProfile):
        arguments["log_std_init"] = profile.settings.log_std_init
    return arguments
