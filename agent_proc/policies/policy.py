"""The protocol of a policy, which decides about each push cycle."""

from typing import Protocol

from agent_proc.frames.push_view import PushView
from legpush.messages.stepping import Push


class Policy(Protocol):
    """Chooses push cycles; equal views have to give equal choices, so that a mission can be replayed."""

    def decide(self, view: PushView) -> Push | None:
        """The next push cycle, or None if the box is at its goal or pushing cannot improve it."""
