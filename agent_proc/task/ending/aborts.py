"""When an episode of a training is given up."""

from agent_proc.frames.push_view import PushView
from agent_proc.task.reward.progress import errors_in_tolerances
from agent_proc.task.term import AbortTerm
from legpush.bounds import Reading


class Astray(AbortTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The errors of position and angle, each in tolerances, add up to much more than at the start."""

    more: Reading = 5.0
    """How much more."""

    def aborts(self, first: PushView, now: PushView) -> bool:
        """Whether they have grown by more than that."""
        return sum(errors_in_tolerances(now)) > sum(errors_in_tolerances(first)) + self.more
