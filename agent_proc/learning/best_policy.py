"""Finds the best policy of a training: builds it from the learner, evaluates and ranks it."""

import threading
from collections.abc import Callable, Sequence

from agent_proc.evaluation.episodes import evaluate, summarize
from agent_proc.evaluation.starts import FIRST_CHECK_SEED, starts_of
from agent_proc.learning.learner import Learner, observation_moments
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.policies.actor import Normalizer
from agent_proc.policies.card import Card, Check, CurvePoint
from agent_proc.policies.folder import PolicyFolder
from agent_proc.policies.learned import NetworkPolicy
from agent_proc.policies.reach import Reach
from agent_proc.policies.sb3.layers import actor_layers
from legpush.lockstep.world import SteppingWorld


def build_policy(
    plan: TrainingPlan, learner: Learner, curve: Sequence[CurvePoint], reach: Reach, check: Check | None
) -> PolicyFolder:
    """Build the present policy of the learner; `check` is its evaluation, None before there is one."""
    card = Card(
        command=plan.command,
        task=plan.task,
        profile=plan.profile,
        seed=plan.seed,
        steps=learner.model.num_timesteps,
        n_simulators=plan.n_simulators,
        versions=plan.versions,
        check=check,
        curve=tuple(curve),
        reach=reach,
        world=plan.world,
        init=plan.init,
    )
    normalizer = None
    if (moments := observation_moments(learner.normalizer)) is not None:
        mean, variance = moments
        normalizer = Normalizer(mean=mean, variance=variance)
    layers = actor_layers(plan.profile.algorithm, learner.model.policy.state_dict())
    return PolicyFolder(card=card, layers=layers, normalizer=normalizer)


def check_policy(
    policy: PolicyFolder, worlds: Sequence[SteppingWorld], *, on_episode: Callable[[], None], stop: threading.Event
) -> Check:
    """Evaluate the deterministic policy as its task says; `on_episode` is called after each episode.

    Raises:
        StopRequestedError: `stop` was set.
    """
    card = policy.card
    seeds = range(FIRST_CHECK_SEED, FIRST_CHECK_SEED + card.profile.evaluation_episodes)
    rows = evaluate(
        worlds,
        {"": card.task.scenario},
        seeds,
        policy_in_training(policy),
        on_row=lambda _: on_episode(),
        stop=stop,
        drawn=starts_of(card.task),
    )
    summary = summarize(rows)[""]
    return Check(
        step=card.steps,
        seeds=tuple(seeds),
        success_rate=summary.success_rate.value,
        position_error_m=summary.position_error_m.value,
        angle_error_deg=summary.angle_error_deg.value,
        falls=summary.n_falls,
        cycles=summary.n_cycles.value,
    )


def policy_in_training(policy: PolicyFolder) -> NetworkPolicy:
    """The policy as it is judged: it stops nowhere, so that all that it does shows."""
    return NetworkPolicy(policy.card.task, policy.actor(), policy.normalizer, "the policy in training")


def is_better(check: Check, best: Check | None) -> bool:
    """Whether a policy with this evaluation replaces the best one up to now."""
    return best is None or _rank(check) > _rank(best)


def _rank(check: Check) -> tuple[int, float, float]:
    """Sort key: fewer falls, then more success, then less error, where 1 cm counts as much as 1 degree."""
    return -check.falls, check.success_rate, -(100 * check.position_error_m + check.angle_error_deg)
