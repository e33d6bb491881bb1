"""A planner as a function: the seam at which another planner is plugged in."""

from collections.abc import Callable, Iterator

from legpush.messages.planning import Plan, PlanQuery

Interrupted = Callable[[], bool]
"""Asked now and then during a search: whether to stop, by raising `PlanningInterruptedError`."""
MakePlans = Callable[[PlanQuery, Interrupted], Iterator[Plan]]
"""The revisions of a plan, one for a query without `anytime`."""


class PlanningInterruptedError(Exception):
    """The answer is not wanted any more, or not now."""
