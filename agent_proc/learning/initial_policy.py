"""Begins a training with what another one learned, such as one in a world without physics."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from stable_baselines3 import TD3

from agent_proc.learning.checkpoint import CHECKPOINT_FILE, load_checkpoint
from agent_proc.learning.learner import Learner, set_observation_moments
from agent_proc.learning.learner_state import restore_moments, restore_networks
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.policies.actor import Layer
from agent_proc.policies.alike import require_alike
from agent_proc.policies.folder import PolicyFolder, policy_path, read_policy
from agent_proc.policies.reach import Visits
from agent_proc.policies.sb3.layers import layer_names
from legpush.errors import PolicyError


def begin_with(learner: Learner, plan: TrainingPlan, name_or_path: str) -> Visits:
    """Give a new learner what a trained policy has, or a training whose folder is named.

    A policy has an actor, and mean and variance of its observations. The last checkpoint of a training also has the
    critics, the spread of exploration and the variance of the rewards. Optimizers and random numbers stay new. Returns
    how far off it decided in its training, if there is a checkpoint.

    Raises:
        PolicyError: There is no such policy, or it was trained with another algorithm, network, observation or action.
        CheckpointError: The checkpoint cannot be used.
    """
    checkpoint = Path(name_or_path) / CHECKPOINT_FILE
    if not checkpoint.is_file():
        _take(learner, plan, read_policy(policy_path(name_or_path)), name_or_path)
        return Visits()
    held = load_checkpoint(checkpoint)
    state = held.learner
    try:
        restore_networks(learner.model, state)
        restore_moments(learner.normalizer, state)
    except ValueError as error:
        raise PolicyError(f"{name_or_path}: expected a training with the networks of this one: {error}") from error
    return held.visits


def _take(learner: Learner, plan: TrainingPlan, policy: PolicyFolder, where: str) -> None:
    """Give the learner the actor of a policy, and the moments of its observations."""
    require_alike(plan.profile, plan.task, policy.card, where)
    model, normalizer = learner.model, learner.normalizer
    weights = model.policy.state_dict()
    names = layer_names(plan.profile.algorithm, weights)
    model.policy.load_state_dict(weights | _tensors(dict(zip(names, policy.layers, strict=True))))
    if isinstance(model, TD3):
        model.policy.actor_target.load_state_dict(model.policy.actor.state_dict())
    if policy.normalizer is not None:
        set_observation_moments(normalizer, policy.normalizer, policy.card.steps)


def _tensors(layers: Mapping[tuple[str, str], Layer]) -> dict[str, Any]:
    """Weights and biases by their names."""
    return {
        name: torch.from_numpy(array.copy())
        for (weight, bias), layer in layers.items()
        for name, array in ((weight, layer.weight), (bias, layer.bias))
    }
