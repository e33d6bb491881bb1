"""Compares what a recording should have with what it has, by sequences per key and incarnation, and by farewells."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Final

from legpush.messages.common import Role
from legpush.messages.telemetry import Copies, Copy, Origin

WITNESSED: Final[tuple[Role, ...]] = ("planner",)
"""Roles whose messages other processes may hand over."""
MAX_HEARD: Final = 10_000
"""Largest distance between a witness and the process that it hears, in messages of a key."""


@dataclass(frozen=True, kw_only=True)
class Completeness:
    """Whether a recording has everything that was published since it began, and what is missing."""

    complete: bool
    n_recorded: int
    n_missing: int
    """As far as the sequences show it."""
    notes: tuple[str, ...]
    """Sentences about what is missing, what may be missing, and what came before the recording began."""


@dataclass
class _Account:
    """The messages of one key of one incarnation."""

    first: int
    """The first sequence that this recorder could have had."""
    n_recorded: int = 0
    n_published: int = 0

    def n_missing(self) -> int:
        """Return the number of missing messages from the first one on."""
        return max(0, self.n_published - self.first - self.n_recorded)


class _Heard:
    """The recorded sequences of a key. The oldest ones are kept as a bound only, which limits the memory."""

    def __init__(self) -> None:
        self._below = 0
        self._sequences: set[int] = set()

    def __contains__(self, sequence: int) -> bool:
        return sequence < self._below or sequence in self._sequences

    def add(self, sequence: int) -> None:
        """Add a sequence."""
        self._sequences.add(sequence)
        if len(self._sequences) > 2 * MAX_HEARD:
            kept = sorted(self._sequences)[-MAX_HEARD:]
            self._below, self._sequences = kept[0], set(kept)


@dataclass
class _Source:
    """One incarnation of a process."""

    label: str
    accounts: dict[str, _Account] = field(default_factory=dict)
    n_batches: dict[str, int] = field(default_factory=dict)
    """By the incarnation that handed them over: the source itself, or a witness."""
    heard: dict[str, _Heard] = field(default_factory=dict)
    """By key, for witnessed roles only: each message counts once, even if two processes hand it over."""
    final: bool = False


class Ledger:
    """A recorder's account of the batches that came; a batch counts once, even if it is sent again."""

    def __init__(self) -> None:
        self._sources: dict[str, _Source] = {}
        self._silent: dict[str, str] = {}

    def note_process(self, origin: Origin) -> None:
        """Note that a process is alive, which may not hand over copies."""
        if origin.incarnation not in self._sources:
            self._silent[origin.incarnation] = _label(origin)

    def is_new(self, batch: Copies) -> bool:
        """Return whether this batch was not taken before."""
        source = self._sources.get(batch.origin.incarnation)
        return source is None or batch.batch >= source.n_batches.get(batch.header.incarnation, 0)

    def fresh(self, batch: Copies) -> tuple[Copy, ...]:
        """Return the copies that no other process has handed over; the agent may hand over a planner's messages."""
        source = self._sources.get(batch.origin.incarnation)
        if source is None or batch.origin.role not in WITNESSED:
            return batch.copies
        return tuple(copy for copy in batch.copies if copy.sequence not in source.heard.get(copy.key, ()))

    def note_batch(self, batch: Copies, copies: Sequence[Copy], recorded: set[str]) -> None:
        """Note a batch, of which `copies`, those under the keys `recorded`, are in the file."""
        origin = batch.origin
        self._silent.pop(origin.incarnation, None)
        source = self._sources.setdefault(origin.incarnation, _Source(_label(origin)))
        source.n_batches[batch.header.incarnation] = batch.batch + 1
        source.final |= batch.final
        for published in batch.published:
            if published.key in recorded:
                account = source.accounts.setdefault(published.key, _Account(published.since))
                account.first = min(account.first, published.since)
                account.n_published = max(account.n_published, published.n)
        for copy in copies:
            source.accounts.setdefault(copy.key, _Account(copy.sequence)).n_recorded += 1
            if origin.role in WITNESSED:
                source.heard.setdefault(copy.key, _Heard()).add(copy.sequence)

    def unfinished(self) -> set[str]:
        """Return the incarnations that have not said farewell."""
        return {incarnation for incarnation, source in self._sources.items() if not source.final} | self._silent.keys()

    def completeness(self, live: Collection[str] = ()) -> Completeness:
        """Return the state of the recording now; the `live` incarnations need not have said farewell.

        Messages from before the recorder came are not counted as missing, but noted.
        """
        losses = [f"{label} hands over no copies: its messages are missing" for label in self._silent.values()]
        before: list[str] = []
        if not self._sources and not self._silent:
            losses.append("no process was there to be recorded")
        n_recorded = n_missing = 0
        for incarnation, source in self._sources.items():
            for key, account in source.accounts.items():
                n_recorded += account.n_recorded
                n_missing += account.n_missing()
                if account.n_missing():
                    n_expected = account.n_published - account.first
                    losses.append(
                        f"{key} of {source.label}: {account.n_missing()} of {n_expected} messages are missing"
                    )
                if account.first:
                    before.append(f"{key} of {source.label}: {account.first} messages before the recording began")
            if not source.final and incarnation not in live:
                losses.append(f"{source.label} did not say farewell: its last messages may be missing")
        notes = (*losses, *before)
        return Completeness(complete=not losses, n_recorded=n_recorded, n_missing=n_missing, notes=notes)


def _label(origin: Origin) -> str:
    return f"{origin.role} {origin.name} ({origin.incarnation})"
