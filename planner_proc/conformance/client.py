"""The two ends of a check: the planner's process, and clients that ask it over the bus."""

import os
import signal
import threading
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
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

RUN: Final = "plan-check"
SLICE_S: Final = 0.05
RESEND_S: Final = 2.0


class PlannerProcess:
    """A context manager: the planner's command with the flags of the protocol; no process is left on exit."""

    def __init__(self, command: Sequence[str], log: Path, stop: threading.Event) -> None:
        self.log = log
        self._command = tuple(command)
        self._stop = stop
        self._crew = Crew()
        self._closing = ExitStack()

    def __enter__(self) -> Self:
        directory = Path(self._closing.enter_context(TemporaryDirectory(prefix="legpush-check-")))
        self.endpoints = Endpoints(connect=in_directory(directory, "planner").listen)
        self._closing.callback(self._crew.stop)
        self.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._closing.close()

    def start(self) -> None:
        """Start it, or start it again."""
        flags = ("--run", RUN, "--listen", *self.endpoints.connect)
        environment = child_environment(os.environ)
        command = Command(role="planner", argv=(*self._command, *flags), log=self.log, environment=environment)
        self._process: Process = self._crew.start(command)

    def kill(self) -> None:
        """End it as a crash would."""
        self._process.signal(signal.SIGKILL)
        until_s = monotonic() + 5.0
        while self._process.exit_code is None and monotonic() < until_s:
            self._crew.next_event(SLICE_S)

    def end(self) -> str:
        """How it ended, and its last words; nothing while it runs."""
        if self._stop.is_set():
            raise StopRequestedError("interrupted")
        code = self._process.exit_code
        if code is None:
            return ""
        words = "; ".join(self._process.last_words()[-3:])
        return f"the process {describe_exit(code)}: {words}" if words else f"the process {describe_exit(code)}"


class Client:
    """Asks for plans under its own name; everything that is answered is kept until it is taken."""

    def __init__(self, bus: Bus, planner: PlannerProcess) -> None:
        self.bus = bus
        self._planner = planner
        self._results = bus.subscribe(channels.plan_results(bus.run, bus.name))
        self._requests = bus.publisher(channels.plan_requests(bus.run, bus.name))
        self._cancels = bus.publisher(channels.plan_cancels(bus.run, bus.name))
        bus.announce()
        self._next_id = 0
        self._n_invalid = 0

    def new_id(self) -> int:
        """One that was not used before."""
        self._next_id += 1
        return self._next_id - 1

    def wait_for_planner(self, deadline_s: float) -> str:
        """Until one token of a planner is up; what is wrong otherwise."""
        until_s = monotonic() + deadline_s
        while monotonic() < until_s:
            if len(self.bus.liveliness.live("planner")) == 1:
                return ""
            if ended := self._planner.end():
                return ended
            threading.Event().wait(SLICE_S)
        return f"no liveliness token {keys.liveliness(RUN, 'planner', 'main', '<incarnation>')} within {deadline_s:g} s"

    def send(self, request_id: int, query: PlanQuery) -> PlanRequest:
        """Publish a request."""
        return self._requests.send(lambda header: PlanRequest(header=header, request_id=request_id, query=query))

    def cancel(self, request_id: int) -> None:
        """Publish that a request is not wanted any more."""
        self._cancels.send(lambda header: PlanCancel(header=header, request_id=request_id))

    def send_raw(self, payload: bytes) -> None:
        """Publish bytes as a request, whatever they are."""
        self.bus.put(keys.plan_request(self.bus.run, self.bus.name), payload)

    def results(self, request_id: int, for_s: float, at_most: int = 1) -> list[PlanResult]:
        """Answers to a request, as they come within the time."""
        until_s = monotonic() + for_s
        found: list[PlanResult] = []
        while len(found) < at_most and monotonic() < until_s:
            result = self._results.next(SLICE_S)
            if result is None:
                if self._planner.end():
                    break
            elif (result.client_incarnation, result.request_id) == (self.bus.incarnation, request_id):
                found.append(result)
        return found

    def ask(self, query: PlanQuery, deadline_s: float) -> PlanResult | str:
        """The answer to a new request, or what was wrong instead."""
        results = self.insist(self.new_id(), query, deadline_s)
        return results[0] if results else self.silence(deadline_s)

    def insist(self, request_id: int, query: PlanQuery, deadline_s: float) -> list[PlanResult]:
        """Send a request again until it is answered, as clients do: a copy may get lost, or be taken as answered
        with the one before.
        """
        until_s = monotonic() + deadline_s
        found: list[PlanResult] = []
        while not found and monotonic() < until_s and not self._planner.end():
            self.send(request_id, query)
            found = self.results(request_id, RESEND_S)
        return found

    def silence(self, deadline_s: float) -> str:
        """Why there was no answer."""
        if ended := self._planner.end():
            return ended
        refused = self.bus.tally.details()
        if refused:
            return f"no valid answer within {deadline_s:g} s; what came: " + "; ".join(refused.values())
        return f"no answer within {deadline_s:g} s"

    def example(self, query: PlanQuery) -> dict[str, object]:
        """A request as plain maps, to be broken."""
        plain: dict[str, object] = codec.unpack(codec.encode(self.send(self.new_id(), query)))
        return plain
