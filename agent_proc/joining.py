"""Joins simulators that already run: which ones there are, which of them fit together, and which are spare."""

import logging
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from legpush.bus.bundles.asking import AskingSession
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, listing
from legpush.bus.session import ZenohSession
from legpush.bus.transport import Session
from legpush.errors import PeerError, StopRequestedError
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.patience import SLICE_S, Patience, Stopwatch

log = logging.getLogger(__name__)


@contextmanager
def joined_simulators(
    n: int, run: str, endpoints: Endpoints, stop: threading.Event, patience: Patience | None = None
) -> Iterator[list[BusWorld]]:
    """Give a world for each of the first `n` simulators, by name, of a running run.

    All of them compute with equal numerics. The others of the run are spare: one takes the place of a simulator that
    is gone for a while, and goes on with its episode. Simulators of one process are asked together.

    Raises:
        PeerError: Fewer than `n` simulators with equal numerics were found within the deadline.
        StopRequestedError: `stop` was set.
    """

    def open_session(at: Endpoints, who: str) -> Session:
        return AskingSession(ZenohSession(at, who, stop), run)

    with Bus(run, "agent", "main", endpoints, stop=stop, open_session=open_session) as bus:
        roster = Roster(bus)
        names = roster.first(n, stop, (patience or Patience()).deadline_s)
        worlds = [BusWorld(SimLink(bus, name, stop=stop, patience=patience, spares=roster)) for name in names]
        bus.announce()
        yield worlds


class Roster:
    """Which simulators of a run are used, and which are spare.

    Only simulators with equal numerics fit: an episode may go on in any of them.
    """

    def __init__(self, bus: Bus) -> None:
        """Nobody is used yet."""
        self._bus = bus
        bus.follow("sim")
        self._used: set[str] = set()
        self._numerics = ""
        """Those of the simulators that are used."""
        self._unfit: set[str] = set()
        """Names of those that compute with other numerics."""
        self._lock = threading.Lock()
        """Worlds step in threads of their own."""

    def first(self, n: int, stop: threading.Event, deadline_s: float) -> tuple[str, ...]:
        """Wait until `n` simulators are there that fit together, and use the first ones by name.

        Raises:
            PeerError: There are fewer within the deadline; names those that do not fit.
            StopRequestedError: `stop` was set.
        """
        waited = Stopwatch()
        while not stop.is_set():
            known = self._known()
            usual = Counter(known.values()).most_common(1)
            if usual and usual[0][1] >= n:
                self._numerics = usual[0][0]
                names = self._fitting(known)[:n]
                self._used = set(names)
                return tuple(names)
            if waited.tick() > deadline_s:
                raise PeerError(self._too_few(n, known, deadline_s))
            stop.wait(SLICE_S)
        raise StopRequestedError(f"Asked to stop while waiting for {n} simulators")

    def any(self) -> bool:
        """Whether there is a spare one."""
        return bool(self._spare())

    def take(self, lost: str) -> str | None:
        """The first spare one by name, which is used from now on in the place of `lost`."""
        with self._lock:
            spare = self._spare()
            if not spare:
                return None
            self._used.remove(lost)
            self._used.add(spare[0])
            return spare[0]

    def _spare(self) -> list[str]:
        return [name for name in self._fitting(self._known()) if name not in self._used]

    def _fitting(self, known: dict[str, str]) -> list[str]:
        """The names of those with the numerics of the simulators that are used, sorted."""
        for name in known.keys() - self._unfit:
            if known[name] != self._numerics:
                self._unfit.add(name)
                log.warning(
                    "sim/%s is not used: it computes with %s, the others with %s", name, known[name], self._numerics
                )
        return sorted(name for name, numerics in known.items() if numerics == self._numerics)

    def _known(self) -> dict[str, str]:
        """The numerics of the live simulators that have said what they compute with."""
        live = self._bus.liveliness.live("sim")
        return {peer.name: peer.numerics for peer in live if peer.numerics is not None}

    def _too_few(self, n: int, known: dict[str, str], deadline_s: float) -> str:
        bus = self._bus
        found = [f"{name} with {numerics}" for name, numerics in sorted(known.items())]
        others = bus.liveliness.other_versions("sim")
        found += [f"{name} of another version, with protocol {protocol}" for name, protocol in sorted(others.items())]
        return (
            f"Expected {n} simulators with equal numerics in run {bus.run} within {deadline_s:g} s, found "
            f"{', '.join(found) or 'none'}, listening on {listing(bus.endpoints.listen)}, connecting "
            f"to {listing(bus.endpoints.connect)}; `python -m sim_proc --run {bus.run} --name NAME` starts one"
        )
