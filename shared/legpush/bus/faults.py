"""A bad channel on purpose: messages dropped, duplicated, delayed and reordered by a table that a seed draws.

`legpush run --inject-faults 0.2`, or the same flag of any process, puts one in front of every lockstep and plan message
that the process sends. The mission must end in the same state as without. The table of a channel depends on the seed
and the key alone, so message number k of a key meets the same fate in every run with that seed.
"""

import heapq
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import count
from time import monotonic
from typing import Final
from zlib import crc32

import numpy as np

from legpush.errors import ConfigError

TABLE_ROWS: Final = 4096
LONGEST_DELAY_S: Final = 0.05


@dataclass(frozen=True, kw_only=True)
class Faults:
    """How bad the channel is."""

    probability: float
    """Of each of the four faults, for each message, independently."""
    seed: int = 0

    def __post_init__(self) -> None:
        if not 0.0 <= self.probability < 1.0:
            raise ConfigError(f"Expected a probability in [0, 1) for injected faults, got {self.probability}")


@dataclass(frozen=True)
class Fate:
    """What happens to one message."""

    dropped: bool
    duplicated: bool
    delay_s: float
    """0 for none."""
    reordered: bool
    """Held back until the following message has gone."""


def fate_table(faults: Faults, key: str, n_rows: int = TABLE_ROWS) -> tuple[Fate, ...]:
    """The fates of messages 0, 1, ... under `key`; after the last row the table starts again."""
    rng = np.random.default_rng([faults.seed, crc32(key.encode())])
    hit = rng.random((n_rows, 4)) < faults.probability
    delays_s = rng.uniform(0.0, LONGEST_DELAY_S, n_rows)
    return tuple(
        Fate(bool(row[0]), bool(row[1]), float(delay) if row[2] else 0.0, bool(row[3]))
        for row, delay in zip(hit, delays_s, strict=True)
    )


class BadChannel:
    """Stands between a publisher and the network; message k meets the fate in row k of the table, which then repeats.

    `deliver` sends for real, on the caller's thread or on one of its own.
    """

    def __init__(self, table: Sequence[Fate], deliver: Callable[[bytes], None]) -> None:
        self._table = table
        self._deliver = deliver
        self._n_sent = 0
        self._held: list[tuple[bytes, Fate]] = []
        self._changed = threading.Condition()
        self._due: list[tuple[float, int, bytes]] = []
        self._ticket = count()
        self._open = True
        self._postman = threading.Thread(target=self._deliver_when_due, name="faults", daemon=True)
        self._postman.start()

    def send(self, payload: bytes) -> None:
        """Let the next row of the table decide what becomes of `payload`; not from two threads at once."""
        fate = self._table[self._n_sent % len(self._table)]
        self._n_sent += 1
        overtaken, self._held = self._held, []
        if not fate.dropped:
            if fate.reordered:
                self._held.append((payload, fate))
            else:
                self._pass_on(payload, fate)
        for late_payload, late_fate in overtaken:
            self._pass_on(late_payload, late_fate)

    def close(self) -> None:
        """Lose what is still under way."""
        with self._changed:
            self._open = False
            self._changed.notify()
        self._postman.join()

    def _pass_on(self, payload: bytes, fate: Fate) -> None:
        copies = 2 if fate.duplicated else 1
        for _ in range(copies):
            if fate.delay_s == 0.0:
                self._deliver(payload)
                continue
            with self._changed:
                heapq.heappush(self._due, (monotonic() + fate.delay_s, next(self._ticket), payload))
                self._changed.notify()

    def _deliver_when_due(self) -> None:
        while True:
            with self._changed:
                while self._open and not (self._due and self._due[0][0] <= monotonic()):
                    self._changed.wait(self._due[0][0] - monotonic() if self._due else None)
                if not self._open:
                    return
                payload = heapq.heappop(self._due)[2]
            self._deliver(payload)
