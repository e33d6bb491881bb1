"""Look-ahead by true physics: pushes are carried out in copies of the world, and the best ones are gone on with.

This is an oracle: it knows the box, the floor and the sensors as they are, which no policy does. What comes after the
pushes that are carried out is predicted as in `LookAhead`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.policies.scripted import CYCLE_COST
from agent_proc.rivals.best_face import measured_model
from agent_proc.rivals.lookahead import LookAhead, depths_m, predicted_costs
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from agent_proc.walking.around_box import can_push
from legpush.errors import MotionError
from legpush.lockstep.local import LocalWorld
from legpush.messages.poses import as_seen
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS

N_KEPT: Final = 3
"""Sequences that are gone on with after each push."""
N_PUSHES: Final = 2
"""Pushes that are carried out in copies."""
NOTHING_FREE: Final = np.zeros((1, 0, 2))
Fork = Callable[[LocalWorld | None], LocalWorld]
"""Copies a world with its present state: that of the episode, or another copy."""


@dataclass(frozen=True, kw_only=True)
class _Sequence:
    """Pushes that were carried out in a copy of the world, which is as they left it."""

    pushes: tuple[Push, ...]
    world: LocalWorld | None
    view: PushView
    cost: float


class PhysicsLookAhead:
    """Carries out every push of a grid in copies of the world; goes to a face that may be better."""

    def __init__(self, task: TaskConfig, fork: Fork) -> None:
        self._task = task
        self._fork = fork
        self._over_map = LookAhead(task)

    def decide(self, view: PushView) -> Push | None:
        """The first push of the best sequence, or None if nothing is left to do."""
        if has_arrived(self._task, view):
            return None
        if self._task.changes_face:
            elsewhere = self._over_map.decide(view)
            if elsewhere is not None and elsewhere.face != view.face:
                return elsewhere
        kept = [_Sequence(pushes=(), world=None, view=view, cost=np.inf)]
        found: list[_Sequence] = []
        for _ in range(N_PUSHES):
            carried_out = [each for sequence in kept for each in self._went_on(sequence, view)]
            found += carried_out
            kept = sorted(carried_out, key=lambda each: each.cost)[:N_KEPT]
        return min(found, key=lambda each: each.cost).pushes[0] if found else None

    def _went_on(self, sequence: _Sequence, seen: PushView) -> list[_Sequence]:
        """The sequences with one push more, but for those that are refused or after which the robot has fallen."""
        if sequence.pushes and has_arrived(self._task, sequence.view):
            return []
        found = []
        for leg, depth_m in product(FRONT_LEGS, depths_m(self._task, sequence.view)):
            world = self._fork(sequence.world)
            push = Push(w1=0.5, w2=0.5, leg=leg, depth_m=depth_m, face=seen.face)
            try:
                after = world.step(push).world
            except MotionError:
                continue
            if after.fallen or not can_push(as_seen(after), seen.scenario, seen.face):
                continue
            view = push_view(after, seen.scenario, seen.felt, seen.face)
            pushes = (*sequence.pushes, push)
            found.append(_Sequence(pushes=pushes, world=world, view=view, cost=self._cost(view, len(pushes))))
        return found

    def _cost(self, view: PushView, n_pushes: int) -> float:
        """Least error to come in tolerances, or the present one, with the cost of the pushes."""
        depths = depths_m(self._task, view)
        ahead = predicted_costs(view, measured_model(view.face), NOTHING_FREE, max(depths), min(depths))
        goal, error = view.goal, view.error
        position = error.position_m / goal.position_tolerance_m
        present = float(np.hypot(position, np.degrees(error.angle_rad) / goal.angle_tolerance_deg))
        return min(float(ahead[0]), present) + CYCLE_COST * n_pushes
