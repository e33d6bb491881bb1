"""A process of one or several simulators: its command line, its place on the bus, and a thread for each simulator."""

import logging
import secrets
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

from legpush.arguments import arg
from legpush.bounds import Simulators
from legpush.bus import keys
from legpush.bus.bundles.answering import AnsweringSession
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints
from legpush.bus.session import ZenohSession
from legpush.bus.transport import Session
from legpush.errors import ConfigError
from legpush.fields import MAX_NAME, require
from legpush.lockstep.server import serve_actions
from legpush.lockstep.simulator import Stepper
from legpush.service import ServiceConfig, run_service

log = logging.getLogger(__name__)

PROCESS_BYTES: Final = 6
"""Random bytes in the name of a process."""


@dataclass(frozen=True, kw_only=True)
class SimConfig(ServiceConfig):
    """Options of the simulator.

    Environment: LEGPUSH_RUN, LEGPUSH_LISTEN, LEGPUSH_CONNECT, LEGPUSH_ROUTER (endpoints by commas).
    """

    simulators: Annotated[int, arg("N")] = 1
    """Simulators of this process. If there are several, they are named NAME-1, NAME-2, ..., and a learner that joins
    them asks them together, by one message."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Simulators, self.simulators, "--simulators")
        room = MAX_NAME - len(member_name("", self.simulators))
        if self.simulators > 1 and len(self.name) > room:
            raise ConfigError(
                f"Expected 1 to {room} letters, digits, - or _ for --name with --simulators {self.simulators}, "
                f"got {self.name!r}"
            )


def member_name(name: str, number: int) -> str:
    """Name of one of several simulators, from 1."""
    return f"{name}-{number}"


def run_simulators(make: Callable[[Bus], Stepper]) -> int:
    """Run a process whose simulators are what `make` makes; returns the exit code."""

    def connect_and_serve(config: SimConfig, at: Endpoints, stop: threading.Event) -> None:
        if config.simulators == 1:
            with config.bus("sim", at, stop) as bus:
                serve_actions(bus, make(bus), stop)
                _tell_refused([bus])
        else:
            with buses(config, at, stop) as members:
                serve_each(members, make, stop)
                _tell_refused(members)

    return run_service("sim", SimConfig, connect_and_serve)


@contextmanager
def buses(
    config: SimConfig,
    at: Endpoints,
    stop: threading.Event,
    open_session: Callable[[Endpoints, str], Session] | None = None,
) -> Iterator[list[Bus]]:
    """Give a bus for each simulator of this process, all over one session, which `open_session` opens."""
    process = f"bundle{secrets.token_hex(PROCESS_BYTES)}"
    session = (open_session or partial(ZenohSession, stop=stop))(at, f"sim {config.name}")
    shared = AnsweringSession(session, config.run, process)
    with ExitStack() as stack:
        stack.callback(shared.close)
        members = []
        for number in range(1, config.simulators + 1):
            name = member_name(config.name, number)
            bus = Bus(
                config.run,
                "sim",
                name,
                at,
                config.faults(),
                recorded=config.recorded,
                stop=stop,
                open_session=partial(_member, shared, name),
                incarnation=keys.incarnation_of_member(process, number),
                watches_links=number == 1,
            )
            members.append(stack.enter_context(bus))
        yield members


def serve_each(members: list[Bus], make: Callable[[Bus], Stepper], stop: threading.Event) -> None:
    """Answer the actions for each simulator, on a thread of its own, until `stop`; a failure of one ends all."""
    steppers = [make(bus) for bus in members]
    with ThreadPoolExecutor(len(members), thread_name_prefix="simulator") as threads:
        served = [
            threads.submit(serve_actions, bus, stepper, stop) for bus, stepper in zip(members, steppers, strict=True)
        ]
        wait(served, return_when=FIRST_EXCEPTION)
        stop.set()
        for each in served:
            each.result()


def _member(shared: AnsweringSession, name: str, _: Endpoints, __: str) -> Session:
    return shared.member(name)


def _tell_refused(members: list[Bus]) -> None:
    for bus in members:
        log.info("%s is done; refused or dropped: %s", bus.name, bus.tally.as_dict() or "nothing")
