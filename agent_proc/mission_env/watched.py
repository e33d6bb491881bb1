"""A world whose last outcome is kept and drawn."""

from collections.abc import Mapping

from agent_proc.learning.rendering import Rendering
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.world import World
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome


class WatchedWorld:
    """A `World` whose last outcome is kept and drawn."""

    outcome: Outcome

    def __init__(self, world: World, rendering: Rendering | None) -> None:
        self._world = world
        self._rendering = rendering

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Carry out one motion."""
        self.outcome = self._world.step(motion, with_trace=with_trace)
        if self._rendering is not None:
            self._rendering.note(motion, self.outcome)
        return self.outcome

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        """Publish what the last step earned."""
        self._world.tell_reward(terms)

    def plan(self, query: PlanQuery) -> Plan:
        """Return the first answer to a query."""
        return self._world.plan(query)

    def revision(self, revision: int) -> Plan:
        """Return a better answer to the last query."""
        return self._world.revision(revision)

    def cancel_plan(self) -> None:
        """End the search for better answers."""
        self._world.cancel_plan()

    def claim(self, owner: object) -> None:
        """Reserve the simulator for an environment."""
        if isinstance(self._world, LocalWorld):
            self._world.claim(owner)

    def release(self, owner: object) -> None:
        """End the reservation."""
        if isinstance(self._world, LocalWorld):
            self._world.release(owner)
