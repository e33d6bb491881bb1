"""Ten policies from useless to learned, whose order two worlds should agree on."""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count
from typing import Final

import numpy as np

from agent_proc.frames.push_view import PushView
from agent_proc.policies.policy import Policy
from agent_proc.policies.registry import make_policy
from agent_proc.push_model.model import PushModel
from legpush.messages.common import USUAL_DEPTH_M
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS, FrontLeg

MODEL: Final = PushModel()
LEAST_DEPTH_M: Final = 0.005
MAX_DEPTH_M: Final = 0.10

Leg = Callable[[PushView, int], FrontLeg]
"""Chooses the leg of a push by the view and the number of pushes before."""
Depth = Callable[[PushView], float]


@dataclass
class Rule:
    """A rule for the leg and one for the depth; it is done where the box would go farther beyond its goal than it is
    short of it now."""

    leg: Leg
    depth_m: Depth
    n_pushes: "count[int]" = field(default_factory=count)

    def decide(self, view: PushView) -> Push | None:
        """Choose the next push."""
        depth_m = self.depth_m(view)
        travel_m = float(np.interp(depth_m, MODEL.depth_m, MODEL.forward_m))
        if -view.box_g.x_m <= travel_m / 2:
            return None
        return Push(w1=0.5, w2=0.5, leg=self.leg(view, next(self.n_pushes)), depth_m=depth_m)


def usual_depth(_: PushView) -> float:
    """The usual depth of a push."""
    return USUAL_DEPTH_M


def remaining_depth(view: PushView) -> float:
    """The depth that brings the box to its goal, within the bounds of a learned policy."""
    remaining_m = max(0.0, -view.box_g.x_m)
    return float(np.clip(MODEL.depth_for(np.array([remaining_m]))[0], LEAST_DEPTH_M, MAX_DEPTH_M))


def bang_bang(view: PushView, _: int) -> FrontLeg:
    """The leg that turns the box toward the line through the goal."""
    return "FL" if view.steering_error_rad > 0.0 else "FR"


def policy_of(name: str, seed: int) -> Policy:
    """Make the policy for an episode with this seed."""
    if name not in RULES:
        return make_policy(name)
    rng = np.random.default_rng(seed)

    def random_leg(_: PushView, __: int) -> FrontLeg:
        return FRONT_LEGS[int(rng.integers(2))]

    def random_depth(_: PushView) -> float:
        return float(rng.uniform(LEAST_DEPTH_M, MAX_DEPTH_M))

    legs: dict[str, Leg] = {
        "one leg": lambda _, __: "FL",
        "alternate": lambda _, n_before: FRONT_LEGS[n_before % 2],
        "random": random_leg,
        "bang-bang": bang_bang,
    }
    depths: dict[str, Depth] = {"5 cm": usual_depth, "remaining": remaining_depth, "random": random_depth}
    leg, depth = RULES[name]
    return Rule(legs[leg], depths[depth])


RULES: Final = {
    "one leg, 5 cm": ("one leg", "5 cm"),
    "random legs, 5 cm": ("random", "5 cm"),
    "random legs, random depths": ("random", "random"),
    "alternate, 5 cm": ("alternate", "5 cm"),
    "alternate, remaining depth": ("alternate", "remaining"),
    "bang-bang, 5 cm": ("bang-bang", "5 cm"),
    "bang-bang, remaining depth": ("bang-bang", "remaining"),
}
"""Rules for leg and depth by their names."""
POLICIES: Final = (*RULES, "scripted", "fixed", "variable")
"""Names of all ten."""
