"""Arguments for the networks of a policy, from its training profile."""

from itertools import pairwise
from typing import Any, Final

import torch

from agent_proc.policies.folder_files import MAX_BYTES
from agent_proc.profiles.profile import AnyProfile, Network, PpoProfile
from legpush.errors import PolicyError

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


def require_small_networks(network: Network, n_seen: int, where: str) -> None:
    """Check that the networks on a card need no more memory than the file of their weights may have.

    Raises:
        PolicyError: They need more; the message begins with `where`.
    """
    size = 4 * sum(before * after for before, after in pairwise((n_seen, *network.hidden)))
    if size > MAX_BYTES:
        raise PolicyError(
            f"{where}: expected networks of at most {MAX_BYTES} bytes, got {network.hidden}: {size} bytes"
        )
