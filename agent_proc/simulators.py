"""Starts simulators for a learner, or joins running ones."""

import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, listing
from legpush.errors import PeerError, StopRequestedError
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.options.learning import SimulatorOptions
from legpush.patience import SLICE_S, Patience, Stopwatch


@contextmanager
def own_simulators(
    n: int,
    logs: Path,
    stop: threading.Event,
    patience: Patience | None = None,
    record: Path | None = None,
    *,
    kind: str = "simulators",
    folder: Path | None = None,
) -> Iterator[list[BusWorld]]:
    """Start `n` simulators and give a world for each; they end with the context, and one that dies is replaced.

    The worlds are ready at once: each waits for its simulator when it is first stepped. The messages are recorded into
    the new file `record`, if it is given. `kind` and `folder` are those of the `SimPool`.
    """
    from legpush.processes.pool import SimPool

    with (
        SimPool(n, logs, stop, kind=kind, folder=folder, record=record) as pool,
        Bus(pool.run, "agent", "main", pool.endpoints, recorded=record is not None) as bus,
    ):
        yield _worlds(bus, pool.names, stop, patience)


@contextmanager
def joined_simulators(
    n: int, run: str, endpoints: Endpoints, stop: threading.Event, patience: Patience | None = None
) -> Iterator[list[BusWorld]]:
    """Give a world for each of the first `n` simulators, by name, of a running run; its owner replaces dead ones.

    Raises:
        PeerError: Fewer than `n` simulators were found within the deadline.
        StopRequestedError: `stop` was set.
    """
    with Bus(run, "agent", "main", endpoints) as bus:
        names = find_simulators(bus, n, stop, (patience or Patience()).deadline_s)
        yield _worlds(bus, names[:n], stop, patience)


def find_simulators(bus: Bus, n: int, stop: threading.Event, deadline_s: float) -> tuple[str, ...]:
    """Wait until there are `n` live simulators, and return the names of all live ones, sorted.

    Raises:
        PeerError: Fewer than `n` simulators were found within the deadline.
        StopRequestedError: `stop` was set.
    """
    waited = Stopwatch()
    while not stop.is_set():
        names = tuple(sorted({peer.name for peer in bus.liveliness.live("sim")}))
        if len(names) >= n:
            return names
        if waited.tick() > deadline_s:
            raise PeerError(
                f"Expected {n} simulators in run {bus.run} within {deadline_s:g} s, found "
                f"{', '.join(names) or 'none'}, listening on {listing(bus.endpoints.listen)}, connecting "
                f"to {listing(bus.endpoints.connect)}; `python -m sim_proc --run {bus.run} --name NAME` starts one"
            )
        stop.wait(SLICE_S)
    raise StopRequestedError(f"Asked to stop while waiting for {n} simulators")


def _worlds(bus: Bus, names: tuple[str, ...], stop: threading.Event, patience: Patience | None) -> list[BusWorld]:
    worlds = [BusWorld(SimLink(bus, name, stop=stop, patience=patience)) for name in names]
    bus.announce()
    return worlds


def simulators(
    options: SimulatorOptions, logs: Path, stop: threading.Event, *, kind: str, folder: Path | None = None
) -> AbstractContextManager[list[BusWorld]]:
    """Start simulators, or join running ones if the options say so, and give a world for each.

    `kind` and `folder` are the kind of work and its folder, for the recorders and viewers of started simulators.
    """
    if options.join is None:
        return own_simulators(options.n_simulators, logs, stop, record=options.record, kind=kind, folder=folder)
    endpoints = Endpoints(listen=options.listen, connect=options.connect)
    return joined_simulators(options.n_simulators, options.join, endpoints, stop)
