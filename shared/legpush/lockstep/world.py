"""A world as an agent sees it: what it can do there, and what it learns from that."""

from collections.abc import Mapping
from typing import Protocol

from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome


class SteppingWorld(Protocol):
    """Carries out motions, one at a time; an episode begins with a `Reset`."""

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Carry out one motion; the outcome has a trace of every tick if `with_trace`.

        Raises:
            MotionError: The motion cannot be carried out; the state is as it was.
            PeerError: The simulator does not answer in time.
        """

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        """Publish what the last step earned, term by term, for people who watch."""


class World(SteppingWorld, Protocol):
    """A world in which paths can be planned, too: all that a mission needs."""

    def plan(self, query: PlanQuery) -> Plan:
        """Return the planner's first answer to a query.

        Raises:
            PeerError: The planner does not answer in time.
        """

    def revision(self, revision: int) -> Plan:
        """Wait for the better plan with this number, from 1, for the last query; the last plan if there are no more."""

    def cancel_plan(self) -> None:
        """Stop the planner from improving its answer to the last query."""
