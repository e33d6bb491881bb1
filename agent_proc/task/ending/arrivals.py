"""Where a policy has nothing left to do."""

import numpy as np

from agent_proc.frames.push_view import PushView
from agent_proc.task.action import no_push_helps
from agent_proc.task.action_config import ActionConfig
from agent_proc.task.reward.corners import corner_errors_m
from agent_proc.task.term import ArrivalTerm
from legpush.bounds import Distance


class Tolerance(ArrivalTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The box is within the tolerances of its goal, as in the paper."""

    def arrived(self, view: PushView, action: ActionConfig) -> bool:
        """Whether both errors are within them."""
        return view.error.within(view.goal)


class PastGoal(ArrivalTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The box has passed its goal: it cannot be pulled back."""

    beyond_m: Distance = 0.0
    """How far beyond its goal, along the heading of the goal."""

    def arrived(self, view: PushView, action: ActionConfig) -> bool:
        """Whether the centre of the box is at least that far."""
        return view.box_g.x_m >= self.beyond_m


class NoPushHelps(ArrivalTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The shallowest push would carry the box farther beyond its goal than it is short of it now."""

    def arrived(self, view: PushView, action: ActionConfig) -> bool:
        """Whether it would."""
        return no_push_helps(action, view)


class Release(ArrivalTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The rule of the published code: one tracked corner is near its goal, or near it in x alone."""

    corner_m: Distance = 0.10
    """On the floor, less than this."""
    x_m: Distance = 0.05
    """Along the x axis of the world, less than this."""

    def arrived(self, view: PushView, action: ActionConfig) -> bool:
        """Whether one corner is."""
        errors_m = corner_errors_m(view)
        near = np.linalg.norm(errors_m, axis=1) < self.corner_m
        return bool((near | (np.abs(errors_m[:, 0]) < self.x_m)).any())
