"""Starts simulators for a learner, joins running ones, or makes worlds in this process."""

import threading
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import Final, cast

from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, by_router, listing
from legpush.bus.secure.host_folder import credentials_of
from legpush.errors import PeerError, StopRequestedError
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink, Spares
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.simulator import Stepper
from legpush.lockstep.world import SteppingWorld
from legpush.options.learning import DEFAULT_WORLD, SimulatorOptions
from legpush.patience import SLICE_S, Patience, Stopwatch
from legpush.plugins import load_plugin

MAP: Final = "map"
"""The plug-in that takes the file of a response map."""
MAP_SUFFIX: Final = ".json"


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
    """Give a world for each of the first `n` simulators, by name, of a running run.

    All others are spare: one takes the place of a simulator that is gone for a while, and goes on with its episode.

    Raises:
        PeerError: Fewer than `n` simulators were found within the deadline.
        StopRequestedError: `stop` was set.
    """
    with Bus(run, "agent", "main", endpoints, stop=stop) as bus:
        names = find_simulators(bus, n, stop, (patience or Patience()).deadline_s)[:n]
        yield _worlds(bus, names, stop, patience, _Roster(bus, names))


class _Roster:
    """Which simulators of a run are used; the others are spare."""

    def __init__(self, bus: Bus, used: Sequence[str]) -> None:
        self._bus = bus
        self._used = set(used)
        self._lock = threading.Lock()
        """Worlds step in threads of their own."""

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
        return sorted({peer.name for peer in self._bus.liveliness.live("sim")} - self._used)


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


def _worlds(
    bus: Bus,
    names: tuple[str, ...],
    stop: threading.Event,
    patience: Patience | None,
    spares: Spares | None = None,
) -> list[BusWorld]:
    worlds = [BusWorld(SimLink(bus, name, stop=stop, patience=patience, spares=spares)) for name in names]
    bus.announce()
    return worlds


def local_worlds(n: int, name_or_file: str) -> list[SteppingWorld]:
    """Make worlds in this process: with a simulator plug-in each, or with the response map in a file.

    Raises:
        PluginError: There is no such plug-in, or it cannot be imported.
        ConfigError: The file cannot be used.
    """
    if not name_or_file.endswith(MAP_SUFFIX):
        make = load_plugin("legpush.simulators", name_or_file)
        return [LocalWorld(cast(Stepper, make())) for _ in range(n)]
    make_of_file = load_plugin("legpush.simulators", MAP)
    return [LocalWorld(cast(Stepper, make_of_file(Path(name_or_file)))) for _ in range(n)]


def require_world(name_or_file: str) -> None:
    """Require a world that can be made.

    Raises:
        PluginError: There is no such plug-in, or it cannot be imported.
        ConfigError: The file cannot be used.
    """
    if name_or_file != DEFAULT_WORLD:
        local_worlds(1, name_or_file)


def simulators(
    options: SimulatorOptions, logs: Path, stop: threading.Event, *, kind: str, folder: Path | None = None
) -> AbstractContextManager[Sequence[SteppingWorld]]:
    """Give the worlds that the options ask for: started or running simulators, or worlds in this process.

    `kind` and `folder` are the kind of work and its folder, for the recorders and viewers of started simulators.
    """
    if options.world != DEFAULT_WORLD:
        return nullcontext(local_worlds(options.n_simulators, options.world))
    if options.join is None:
        return own_simulators(options.n_simulators, logs, stop, record=options.record, kind=kind, folder=folder)
    credentials = credentials_of(options.secure, "agent")
    endpoints = (
        by_router(options.router, credentials)
        if options.router
        else Endpoints(listen=options.listen, connect=options.connect, credentials=credentials)
    )
    return joined_simulators(options.n_simulators, options.join, endpoints, stop)
