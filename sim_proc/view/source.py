"""What a page shows: a source that adds messages to a history."""

from collections.abc import Collection
from typing import Final, Protocol

from legpush.history.run_history import RunHistory
from legpush.messages.telemetry import Origin

PUMP_S: Final = 0.02
"""Longest time for new messages in each period of the scene."""


class Source(Protocol):
    """Where the page gets the history of a run from."""

    is_live: bool
    is_reading: bool
    """Whether messages that exist already are still being read."""

    @property
    def title(self) -> str:
        """Name of the source, for people."""

    def pump(self, history: RunHistory, budget_s: float) -> None:
        """Add messages that have arrived, for at most `budget_s`."""

    def live(self) -> Collection[Origin] | None:
        """Processes that are alive; None for a recording."""
