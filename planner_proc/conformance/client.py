"""The two ends of a check: the process of the planner, and a client that asks it over the bus."""

import os
import signal
import threading
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from time import monotonic
from types import TracebackType
from typing import Final, Self

from legpush.bus import channels, keys
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, in_directory
from legpush.errors import StopRequestedError
from legpush.messages import codec
from legpush.messages.planning import PlanCancel, PlanQuery, PlanRequest, PlanResult
from legpush.processes.child import Command, Process, describe_exit
from legpush.processes.crew import Crew
from legpush.processes.environment import child_environment
from legpush.runs.live_runs import socket_directory

RUN: Final = "plan-check"
"""Name of the run in which planner and clients meet."""
SLICE_S: Final = 0.05
"""How long to wait before looking again whether the planner still runs."""
RESEND_S: Final = 2.0
"""How long to wait for an answer before sending the request again."""


class PlannerProcess:
    """Runs a planner's command with the flags of the protocol; a context manager that leaves no process behind."""

    def __init__(self, command: Sequence[str], log: Path, stop: threading.Event) -> None:
        """Take the planner's command, the file for its output, and the event that interrupts the checks."""
        self.log = log
        self._command = tuple(command)
        self._stop = stop
        self._crew = Crew()
        self._closing = ExitStack()

    def __enter__(self) -> Self:
        directory = self._closing.enter_context(socket_directory())
        self.endpoints = Endpoints(connect=in_directory(directory, "planner").listen)
        self._closing.callback(self._crew.stop)
        self.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._closing.close()

    def start(self) -> None:
        """Start the planner, or start it again."""
        flags = ("--run", RUN, "--listen", *self.endpoints.connect)
        environment = child_environment(os.environ)
        command = Command(role="planner", argv=(*self._command, *flags), log=self.log, environment=environment)
        self._process: Process = self._crew.start(command)

    def kill(self) -> None:
        """End the planner as a crash would, and wait until it has ended."""
        self._process.signal(signal.SIGKILL)
        until_s = monotonic() + 5.0
        while self._process.exit_code is None and monotonic() < until_s:
            self._crew.next_event(SLICE_S)

    def end(self) -> str:
        """How the planner ended, with the last lines of its log; empty while it runs.

        Raises:
            StopRequestedError: The checks were interrupted.
        """
        if self._stop.is_set():
            raise StopRequestedError("interrupted")
        code = self._process.exit_code
        if code is None:
            return ""
        words = "; ".join(self._process.last_words()[-3:])
        return f"the process {describe_exit(code)}: {words}" if words else f"the process {describe_exit(code)}"


class Client:
    """Asks for plans under the name of its bus; answers wait until they are read.

    Methods that wait give up when the planner ends, and raise `StopRequestedError` when the checks are interrupted.
    """

    def __init__(self, bus: Bus, planner: PlannerProcess) -> None:
        """Take a bus that plays the agent, and the planner that it asks."""
        self.bus = bus
        self._planner = planner
        self._results = bus.subscribe(channels.plan_results(bus.run, bus.name))
        self._requests = bus.publisher(channels.plan_requests(bus.run, bus.name))
        self._cancels = bus.publisher(channels.plan_cancels(bus.run, bus.name))
        bus.announce()
        self._next_id = 0

    def new_id(self) -> int:
        """A request id that was not used before."""
        self._next_id += 1
        return self._next_id - 1

    def wait_for_planner(self, deadline_s: float) -> str:
        """Wait until there is one liveliness token of a planner; returns what is wrong, or empty."""
        until_s = monotonic() + deadline_s
        while monotonic() < until_s:
            if len(self.bus.liveliness.live("planner")) == 1:
                return ""
            if ended := self._planner.end():
                return ended
            threading.Event().wait(SLICE_S)
        return f"no liveliness token {keys.liveliness(RUN, 'planner', 'main', '<incarnation>')} within {deadline_s:g} s"

    def send(self, request_id: int, query: PlanQuery) -> PlanRequest:
        """Publish a request, and return it."""
        return self._requests.send(lambda header: PlanRequest(header=header, request_id=request_id, query=query))

    def cancel(self, request_id: int) -> None:
        """Publish that a request is not wanted any more."""
        self._cancels.send(lambda header: PlanCancel(header=header, request_id=request_id))

    def send_raw(self, payload: bytes) -> None:
        """Publish any bytes as a request."""
        self.bus.put(keys.plan_request(self.bus.run, self.bus.name), payload)

    def next_result(self, request_id: int, for_s: float) -> PlanResult | None:
        """The next answer to a request, or None if it does not come within the time."""
        until_s = monotonic() + for_s
        while monotonic() < until_s:
            result = self._results.next(SLICE_S)
            if result is None:
                if self._planner.end():
                    break
            elif (result.client_incarnation, result.request_id) == (self.bus.incarnation, request_id):
                return result
        return None

    def ask(self, query: PlanQuery, deadline_s: float) -> PlanResult | str:
        """The answer to a new request, or what is wrong."""
        return self.insist(self.new_id(), query, deadline_s) or self.silence(deadline_s)

    def insist(self, request_id: int, query: PlanQuery, deadline_s: float) -> PlanResult | None:
        """Send a request again and again until it is answered; None if it is not.

        A copy may get lost, or the planner may answer it together with the one before.
        """
        until_s = monotonic() + deadline_s
        while monotonic() < until_s and not self._planner.end():
            self.send(request_id, query)
            if result := self.next_result(request_id, RESEND_S):
                return result
        return None

    def silence(self, deadline_s: float) -> str:
        """Why there was no answer."""
        if ended := self._planner.end():
            return ended
        refused = self.bus.tally.details()
        if refused:
            return f"no valid answer within {deadline_s:g} s; what came: " + "; ".join(refused.values())
        return f"no answer within {deadline_s:g} s"

    def example(self, query: PlanQuery) -> dict[str, object]:
        """A request as plain maps, which a check may spoil; it is also sent."""
        plain: dict[str, object] = codec.unpack(codec.encode(self.send(self.new_id(), query)))
        return plain
