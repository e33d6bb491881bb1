"""The common parts of processes and programs: command line, log, signals and exit code.

Exit codes: 0 done, or stopped on request if the work has no end of its own; 2 bad input; 3 a peer or this process
failed; 5 the disk is full; 130 interrupted before the work was done.
"""

import logging
import os
import signal
import threading
import traceback
from _thread import start_new_thread
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Annotated, Literal, Protocol, TypeVar

from legpush.arguments import Flag, OutputOptions, arg
from legpush.arguments import parse as parse_arguments
from legpush.bus import endpoints
from legpush.bus.bus import Bus
from legpush.bus.endpoints import DEFAULT_NAME, DEFAULT_RUN, Endpoints, require_alone
from legpush.bus.faults import Faults
from legpush.bus.secure.host_folder import credentials_of
from legpush.bus.session import log_refused_links
from legpush.errors import FAILED, exit_code_of, one_line
from legpush.fields import Name, require
from legpush.messages.common import Role
from legpush.numerics.current import tell_if_native
from legpush.output.guarded_streams import Output, with_guarded_output
from legpush.output.reply import replying

log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class ServiceConfig:
    """Options of every process.

    Environment: LEGPUSH_RUN, LEGPUSH_LISTEN, LEGPUSH_CONNECT, LEGPUSH_ROUTER (endpoints by commas).
    """

    run: Annotated[str, arg("NAME")] = DEFAULT_RUN
    """Name of the run; processes talk to each other only within one run."""
    name: Annotated[str, arg("NAME")] = DEFAULT_NAME
    """Name of the process, to distinguish several processes of one role; it is a part of the keys."""
    listen: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints to listen on, such as tcp/127.0.0.1:17472 or unixsock-stream//tmp/run/sim.sock."""
    connect: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of the peers to connect to; the peers may start later."""
    router: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of routers (`legpush router`), in the place of --listen and --connect: everything goes through the
    first one that answers, and through another one when it is gone."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """Folder of this host that `legpush secure init` made: talk over TLS alone. The usual endpoints are then ports of
    127.0.0.1: 17471 of the planner, 17472 of the simulator, 17473 of the agent."""
    inject_faults: Annotated[float, arg("P")] = 0.0
    """For tests: drop, duplicate, delay and reorder sent messages, each with this probability."""
    fault_seed: Annotated[int, arg("N")] = 0
    """Seed of the injected faults."""
    recorded: Flag = False
    """Keep copies of all sent messages from the start on, for a recorder that comes later."""
    log_level: Annotated[Literal["debug", "info", "warning", "error"], arg()] = "info"
    """The least severe lines of the log on standard error."""

    def __post_init__(self) -> None:
        for field in ("run", "name"):
            require(Name, getattr(self, field), f"--{field}")

    def endpoints(self, role: Role) -> Endpoints:
        """Return the endpoints to listen on and to connect to; with `--secure`, TLS ports in the place of sockets.

        Raises:
            EndpointError: One of the texts is not an endpoint, or there is a router and other endpoints.
            CredentialsError: The certificate of the process cannot be used.
        """
        credentials, sockets = credentials_of(self.secure, role), endpoints.local(role)
        if self.router:
            for own, usual in ((self.listen, sockets.listen), (self.connect, sockets.connect)):
                require_alone(self.router, () if own == usual else own)
            return endpoints.by_router(self.router, credentials)
        if credentials is None:
            return Endpoints(listen=self.listen, connect=self.connect)
        ports = endpoints.local(role, credentials)
        return Endpoints(
            listen=ports.listen if self.listen == sockets.listen else self.listen,
            connect=ports.connect if self.connect == sockets.connect else self.connect,
            credentials=credentials,
        )

    def faults(self) -> Faults:
        """Return the injected faults.

        Raises:
            ConfigError: Their probability is out of range.
        """
        return Faults(probability=self.inject_faults, seed=self.fault_seed)

    def bus(self, role: Role, at: Endpoints, stop: threading.Event) -> Bus:
        """Return the bus of the process at these endpoints, to be entered."""
        return Bus(self.run, role, self.name, at, self.faults(), recorded=self.recorded, stop=stop)


C = TypeVar("C", bound=ServiceConfig)


class Answering(Protocol):
    """Options of a command, with those about its output."""

    @property
    def output(self) -> OutputOptions:
        """How the command replies."""


A = TypeVar("A", bound=Answering)


def parse(role: Role, kind: type[C], argv: Sequence[str] | None = None, env: Mapping[str, str] = os.environ) -> C:
    """Return the options of a process, of type `kind`, from its command line.

    Defaults come from the environment, or else from the sockets of the role. A wrong flag ends the process with code 2,
    and `--help` with 0.
    """
    sockets = endpoints.local(role)
    default = kind(
        run=env.get("LEGPUSH_RUN", DEFAULT_RUN),
        listen=_locators(env["LEGPUSH_LISTEN"]) if "LEGPUSH_LISTEN" in env else sockets.listen,
        connect=_locators(env["LEGPUSH_CONNECT"]) if "LEGPUSH_CONNECT" in env else sockets.connect,
        router=_locators(env.get("LEGPUSH_ROUTER", "")),
    )
    options: C = parse_arguments(kind, f"python -m {role}_proc", argv, default=default)
    return options


def run_process(role: Role, kind: type[C], work: Callable[[C, Bus, threading.Event], int | None]) -> int:
    """Parse, connect, `work`, disconnect; return the exit code, as `run_service` does."""

    def connect_and_work(config: C, at: Endpoints, stop: threading.Event) -> int:
        with config.bus(role, at, stop) as bus:
            code = work(config, bus, stop) or 0
            log.info("done; refused or dropped: %s", bus.tally.as_dict() or "nothing")
        return code

    return run_service(role, kind, connect_and_work)


def run_service(role: Role, kind: type[C], work: Callable[[C, Endpoints, threading.Event], int | None]) -> int:
    """Parse and `work`, which connects; return the exit code. A `LegpushError` is one line on standard error.

    SIGINT and SIGTERM set the event that `work` gets; the same signal once more ends the process at once. The exit code
    is the result of `work`, where None means 0. Any other exception is a fault of this process: its traceback goes to
    standard error, and the exit code is 3, because 1 would mean that the work was done without success.
    """
    stop = stop_on_signals()

    def parse_and_work(output: Output) -> int:
        config = parse(role, kind)
        output.decides = False
        start_log(f"{role}/{config.name}", config.log_level)
        tell_if_native()
        at = config.endpoints(role)
        if at.credentials is not None:
            log_refused_links()
        return work(config, at, stop) or 0

    def end_well(output: Output) -> int:
        try:
            return exit_code_of(lambda: parse_and_work(output))
        except Exception:  # noqa: BLE001 - whatever it is, the launcher has to learn of it
            with suppress(OSError):  # the log may be on a full disk
                traceback.print_exc()
            return FAILED

    return with_guarded_output(end_well)


def run_program(name: str, work: Callable[[], int]) -> int:
    """Run one of the programs behind the `legpush` command, with `name` in its log lines; return its exit code."""

    def end_well(_: Output) -> int:
        start_log(name, "warning")
        return exit_code_of(work)

    return with_guarded_output(end_well)


def run_command(
    command: str, kind: type[A], work: Callable[[A], int], argv: Sequence[str] | None = None, *, decides: bool = True
) -> int:
    """Run a program that parses the command line of `legpush COMMAND`, as options of the type `kind`.

    `decides` says whether an error of standard output becomes the exit code. Returns the exit code.
    """

    def parse_and_work(output: Output) -> int:
        start_log(command.split()[0], "warning")
        options: A = parse_arguments(kind, f"legpush {command}", argv)
        output.decides = decides
        with replying(options.output):
            return work(options)

    return with_guarded_output(lambda output: exit_code_of(lambda: parse_and_work(output)))


def start_log(who: str, level: str) -> None:
    """Log to standard error, one line per record, with the time and the process `who`."""
    handler = logging.StreamHandler()
    handler.setFormatter(_OneLine(f"%(asctime)s.%(msecs)03d {who} %(levelname)s %(message)s", "%H:%M:%S"))
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)


class _OneLine(logging.Formatter):
    """Formats a record as one line, even if a peer or a file put line breaks into it."""

    def format(self, record: logging.LogRecord) -> str:
        return one_line(super().format(record))


def stop_on_signals() -> threading.Event:
    """Return an event that SIGINT and SIGTERM set; the same signal once more ends the process at once.

    A thread of its own sets it: the signal may come while the main thread holds the lock of the event, because it
    begins to wait for it, and would then wait for itself.
    """
    stop = threading.Event()

    def on_signal(number: int, _: FrameType | None) -> None:
        signal.signal(number, signal.SIG_DFL)
        start_new_thread(stop.set, ())

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, on_signal)
    return stop


def _locators(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())
