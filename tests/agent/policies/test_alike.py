"""With which policies a training can begin, and what is said of the others."""

from dataclasses import replace
from typing import Any

import msgspec
import pytest

from agent_proc.policies.alike import require_alike
from agent_proc.profiles.profile import load_profile
from agent_proc.task.file import load_task
from legpush.errors import PolicyError
from tests.agent.policies.policies import CARD
from tests.agent.tasks import tuned

PROFILE = load_profile("tuned")


def test_a_policy_of_the_same_task_and_profile_is_alike() -> None:
    require_alike(PROFILE, CARD.task, CARD, "here")
    require_alike(PROFILE, tuned(max_steps=7, reward=load_task("push-l1").reward), CARD, "here")


@pytest.mark.parametrize(
    ("task", "message"),
    [
        (tuned(mirrored=False), "got one with mirrored = True in place of False$"),
        (
            load_task("push-l3"),
            "got one without lost_depth, drift, effect; with box.far_m = 1.0 in place of 1.5; with box_near.far_m = ",
        ),
        (tuned(observation={"box": {"far_m": 2.0}}), "got one that also has box_near, .*; with box.far_m = 1.0 in pl"),
        (load_task("push-l1"), "the action of this training, w1, w2, leg, depth, face, got w1, w2, leg, depth$"),
        (tuned(entry="fixed"), "the action of this training, w1, w2, leg, got w1, w2, leg, depth$"),
    ],
)
def test_a_policy_of_another_task_is_refused(task: Any, message: str) -> None:
    with pytest.raises(PolicyError, match=rf"^here: expected a policy with .*{message}"):
        require_alike(PROFILE, task, CARD, "here")


def test_terms_in_another_order_are_another_observation() -> None:
    turned = dict(reversed(CARD.task.observation.items()))
    card = replace(CARD, task=msgspec.structs.replace(CARD.task, observation=turned))
    with pytest.raises(PolicyError, match=r"got one with the order = heading_near, .* in place of box, box_near"):
        require_alike(PROFILE, CARD.task, card, "here")


def test_other_networks_are_refused() -> None:
    network = msgspec.structs.replace(PROFILE.network, hidden=(7, 7))
    profile = msgspec.structs.replace(PROFILE, network=network)
    with pytest.raises(PolicyError, match="the hidden layers of this training, 7, 7, got "):
        require_alike(profile, CARD.task, CARD, "here")
