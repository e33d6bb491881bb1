"""The networks of a policy are as its profile describes them."""

import torch

from agent_proc.policies.sb3.arguments import policy_arguments, use_one_thread
from agent_proc.profiles.profile import PpoProfile, load_profile


def test_layers_and_activation_are_those_of_the_profile() -> None:
    arguments = policy_arguments(load_profile("paper-text"))

    assert arguments["net_arch"] == [512] * 4
    assert arguments["activation_fn"] is torch.nn.ReLU


def test_only_ppo_begins_with_a_spread_of_the_profile() -> None:
    tuned = load_profile("tuned")
    assert isinstance(tuned, PpoProfile)

    assert policy_arguments(tuned)["log_std_init"] == tuned.settings.log_std_init
    assert "log_std_init" not in policy_arguments(load_profile("sac"))


def test_networks_compute_on_one_thread() -> None:
    torch.set_num_threads(2)

    use_one_thread()

    assert torch.get_num_threads() == 1
