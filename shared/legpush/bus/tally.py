"""Counts what was refused or dropped, by cause, and logs it without flooding the log."""

import logging
import threading
from collections import Counter
from time import monotonic

log = logging.getLogger(__name__)

LOG_EVERY_S = 1.0


class Tally:
    """A counter per cause; the first of a cause is logged, then at most one per second with the total."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._counts: Counter[str] = Counter()
        self._details: dict[str, str] = {}
        self._logged_at: dict[str, float] = {}

    def add(self, cause: str, detail: str, level: int = logging.WARNING) -> None:
        """Count one more of `cause`; `detail` says which message it was and what is wrong with it."""
        with self._lock:
            self._counts[cause] += 1
            self._details[cause] = detail
            total, now = self._counts[cause], monotonic()
            if now - self._logged_at.get(cause, -LOG_EVERY_S) < LOG_EVERY_S:
                return
            self._logged_at[cause] = now
        log.log(level, "%s (%d so far): %s", cause, total, detail)

    def __getitem__(self, cause: str) -> int:
        with self._lock:
            return self._counts[cause]

    def details(self) -> dict[str, str]:
        """Of each cause, which message was the last one and what was wrong with it."""
        with self._lock:
            return dict(self._details)

    def as_dict(self) -> dict[str, int]:
        """All causes and how often each came up."""
        with self._lock:
            return dict(self._counts)
