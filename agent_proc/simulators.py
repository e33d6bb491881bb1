"""The worlds of a learner: simulators that it starts, running ones that it joins, or worlds in this process."""

import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cache
from pathlib import Path
from typing import Final, cast

from agent_proc.joining import joined_simulators
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, by_router
from legpush.bus.secure.host_folder import credentials_of
from legpush.errors import ScenarioError
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.simulator import LimitedStepper, Stepper
from legpush.lockstep.world import SteppingWorld
from legpush.options.learning import DEFAULT_WORLD, SimulatorOptions
from legpush.patience import Patience
from legpush.plugins import load_plugin
from legpush.scene.scenario import Scenario

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
        worlds = [BusWorld(SimLink(bus, name, stop=stop, patience=patience)) for name in pool.names]
        bus.announce()
        yield worlds


def local_worlds(n: int, name_or_file: str) -> list[SteppingWorld]:
    """Make worlds in this process: with a simulator plug-in each, or with the response map in a file.

    Raises:
        PluginError: There is no such plug-in, or it cannot be imported.
        ConfigError: The file cannot be used.
    """
    return [LocalWorld(_stepper(name_or_file)) for _ in range(n)]


def _stepper(name_or_file: str) -> Stepper:
    """Make a simulator of this process (`PluginError`, `ConfigError`)."""
    if not name_or_file.endswith(MAP_SUFFIX):
        return cast(Stepper, load_plugin("legpush.simulators", name_or_file)())
    return cast(Stepper, load_plugin("legpush.simulators", MAP)(Path(name_or_file)))


_asked = cache(_stepper)
"""Simulators that are asked alone: a study asks for each of its cells."""


def unknown_in(name_or_file: str, scenarios: Iterable[Scenario]) -> str | None:
    """Say what a world does not know of scenarios; None if it knows all of them.

    Raises:
        PluginError: There is no such plug-in, or it cannot be imported.
        ConfigError: The file cannot be used.
    """
    if name_or_file == DEFAULT_WORLD:
        return None
    stepper = _stepper(name_or_file) if name_or_file.endswith(MAP_SUFFIX) else _asked(name_or_file)
    if isinstance(stepper, LimitedStepper):
        try:
            for scenario in scenarios:
                stepper.require_described(scenario)
        except ScenarioError as error:
            return str(error)
    return None


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
