"""Which workers of a run may get a job, and which of them has none."""

import logging
import threading
from collections import Counter

from legpush.bus.bus import Bus
from legpush.messages.common import Role
from legpush.study.engines.engine import WorkerLostError

log = logging.getLogger(__name__)


class Pool:
    """The live workers of a run, by name: each has one job at a time.

    One that was found unfit gets no further job. Neither do several of one name, as nobody can ask one of them alone.
    Who waits for a worker is woken by what changes, so that waiting costs nothing, however many wait.
    """

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._changed = threading.Condition()
        self._fitting: set[str] = set()
        """Workers that may get jobs."""
        self._busy: set[str] = set()
        self._unfit: set[str] = set()
        """Incarnations of workers that get no further job."""
        self._closed = False
        bus.watch(self._look_at)

    def __len__(self) -> int:
        with self._changed:
            return len(self._fitting | self._busy)

    def take(self) -> str:
        """Wait for a worker that has nothing to do, and return its name.

        Raises:
            WorkerLostError: The pool is closed.
        """
        with self._changed:
            while not self._closed:
                if free := self._fitting - self._busy:
                    self._busy.add(name := min(free))
                    return name
                self._changed.wait()
        raise WorkerLostError("The engine is closed")

    def give_back(self, name: str) -> None:
        """Note that a worker has nothing to do any more."""
        with self._changed:
            self._busy.discard(name)
            self._changed.notify()

    def exclude(self, name: str, incarnation: str) -> None:
        """Give this worker no further job."""
        with self._changed:
            self._unfit.add(incarnation)
            self._look_at("worker", name, incarnation, True)

    def close(self) -> None:
        """End all waits."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def left_out(self) -> list[str]:
        """Return a clause for each live name that gets no job."""
        live = Counter(peer.name for peer in self._bus.liveliness.live("worker"))
        with self._changed:
            return [
                f"{name}, which was refused" if n == 1 else f"{n} processes named {name}, which need names of their own"
                for name, n in sorted(live.items())
                if name not in self._fitting
            ]

    def _look_at(self, role: Role, name: str, _: str, __: bool) -> None:
        """Find out again whether the workers of this name may get jobs."""
        if role != "worker":
            return
        with self._changed:
            live = [peer.incarnation for peer in self._bus.liveliness.live("worker", name)]
            if len(live) == 1 and live[0] not in self._unfit:
                self._fitting.add(name)
                self._changed.notify()
            else:
                self._fitting.discard(name)
            if len(live) > 1:
                log.warning("worker/%s: expected one process of this name, found %d; none gets a job", name, len(live))
