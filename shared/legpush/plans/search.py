"""The search for the plans of one query: a planner that fails in it gives an answer, too."""

import logging
from collections.abc import Iterator

from legpush.errors import OtherVersionError, RecordingError
from legpush.messages import codec
from legpush.messages.planning import Plan, PlanQuery
from legpush.plans.planner import Interrupted, MakePlans, PlanningInterruptedError

log = logging.getLogger(__name__)


def search_plans(make_plans: MakePlans, query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
    """Yield the plans that `make_plans` makes, at least one.

    A planner that raises an exception, or makes a plan that no message can hold, has no better plans after that; if it
    has made none before, one with the status `failed` says what happened.

    Raises:
        PlanningInterruptedError: The search has to make way.
        RecordingError: The planner plays a recording, which does not have this query.
        OtherVersionError: The same, and the recording is of another version.
    """
    n_plans, reason = 0, "The planner ended without a plan"
    try:
        for plan in make_plans(query, interrupted):
            codec.encode(plan)
            yield plan
            n_plans += 1
    except (PlanningInterruptedError, RecordingError, OtherVersionError):
        raise
    except Exception as error:
        reason = f"The planner failed: {type(error).__name__}: {error}"
        log.info("the planner failed at a %s", type(query).__name__, exc_info=error)
    if n_plans == 0:
        yield Plan(status="failed", reason=reason)
