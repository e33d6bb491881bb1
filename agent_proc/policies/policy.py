"""What decides about each push cycle."""

from typing import Protocol

from legpush.messages.stepping import Push, WorldState
from legpush.scene.scenario import Scenario


class Policy(Protocol):
    """Chooses push cycles; equal states have to give equal choices, so that a mission can be replayed."""

    def decide(self, world: WorldState, scenario: Scenario) -> Push | None:
        """The next push cycle, or None when the box is where it should be or pushing cannot improve it."""
