"""Which run a recorder or viewer watches.

In this order:

1. With endpoints (`--connect`, `--router`): what listens there, in the run `--run`, `LEGPUSH_RUN` or `local`.
2. With a name (`--run`, else `LEGPUSH_RUN`): the live run of a launcher that has this name or folder; if there is none,
   processes that were started by hand, on their usual sockets, in the run of this name.
3. With neither: the one live run; several are an error that lists them; if there is none, processes that were started
   by hand, on their usual sockets, in the run `local`.

So `LEGPUSH_RUN` says the same to every process that is started in a terminal: which run it belongs to. Launchers name
their runs themselves, by their folders, whatever it says.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from legpush.bus.endpoints import DEFAULT_RUN, Endpoints, by_router, listing, local
from legpush.bus.secure.host_folder import Credentials
from legpush.errors import ConfigError
from legpush.fields import Name, require
from legpush.runs.live_runs import LiveRun, find_live_runs


@dataclass(frozen=True, kw_only=True)
class ChosenRun:
    """A run, and where its processes listen."""

    run: str
    endpoints: Endpoints
    launched: LiveRun | None = None
    """None where its processes were started by hand."""

    @property
    def folder(self) -> Path | None:
        """What the run leaves behind, where that is known."""
        return Path(self.launched.folder) if self.launched is not None and self.launched.folder is not None else None

    def __str__(self) -> str:
        """For people."""
        return str(self.launched) if self.launched is not None else f"{self.run} at {listing(self.endpoints.connect)}"


def choose_run(
    run: str | None = None, connect: tuple[str, ...] = (), credentials: Credentials | None = None
) -> ChosenRun:
    """Return the run to watch: the live one if there is one, else processes that are started by hand.

    `run` and `connect` are what the command line says. With `credentials`, its processes have to listen on TLS ports.

    Raises:
        ConfigError: Several live runs are meant, or `run` is no name.
        EndpointError: An endpoint has another form, or TLS is missing on one side.
    """
    return find_run(run, connect, credentials) or by_hand(run, (), credentials)


def find_run(
    run: str | None = None, connect: tuple[str, ...] = (), credentials: Credentials | None = None
) -> ChosenRun | None:
    """Like `choose_run`, but returns None while no such run is live, so that callers can poll."""
    if connect:
        return by_hand(run, connect, credentials)
    name, live = _name(run), find_live_runs()
    meant = live if name is None else _called(name, live)
    if not meant:
        return None
    if len(meant) > 1:
        raise ConfigError(f"Expected --run with the name or folder of one of the live runs: {_list(meant)}")
    return ChosenRun(run=meant[0].run, endpoints=_at(meant[0].connect, credentials), launched=meant[0])


def by_hand(run: str | None = None, connect: tuple[str, ...] = (), credentials: Credentials | None = None) -> ChosenRun:
    """Processes that were started by hand, on the usual sockets or TLS ports if no endpoints are given."""
    name = _required_name(run)
    usual = local("recorder", credentials)
    return ChosenRun(run=name, endpoints=_at(connect, credentials) if connect else usual)


def through_routers(run: str | None, routers: tuple[str, ...], credentials: Credentials | None = None) -> ChosenRun:
    """Processes that were started by hand and are reached through routers.

    Raises:
        ConfigError: `run` is no name.
        EndpointError: An endpoint has another form, or TLS is missing on one side.
    """
    return ChosenRun(run=_required_name(run), endpoints=by_router(routers, credentials))


def _required_name(run: str | None) -> str:
    name = _name(run) or DEFAULT_RUN
    try:
        require(Name, name, "--run")
    except ConfigError as error:
        raise ConfigError(f"{error}; live: {_list(find_live_runs()) or 'none'}") from error
    return name


def _at(connect: tuple[str, ...], credentials: Credentials | None) -> Endpoints:
    return Endpoints(connect=connect, credentials=credentials)


def _name(run: str | None) -> str | None:
    """What the command line says, else the environment."""
    return run if run is not None else os.environ.get("LEGPUSH_RUN") or None


def _called(name: str, live: Sequence[LiveRun]) -> Sequence[LiveRun]:
    """Those in this folder, else those of this name."""
    folder = Path(name).resolve()
    in_folder = [run for run in live if run.folder is not None and Path(run.folder).resolve() == folder]
    return in_folder or [run for run in live if run.run == name]


def _list(live: Sequence[LiveRun]) -> str:
    return "; ".join(map(str, live))
