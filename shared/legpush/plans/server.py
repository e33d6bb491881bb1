"""The planner's end of the bus: requests and cancels in, answers out."""

import logging
import threading
from collections.abc import Callable, Iterable
from time import monotonic
from typing import Final

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.ports import Publisher
from legpush.bus.status import StatusBeacon
from legpush.messages.common import Header
from legpush.messages.planning import PlanResult
from legpush.plans.planner import MakePlans
from legpush.plans.request_queue import Answer, RequestQueue

IDLE_S: Final = 0.1
"""How often the stop event is checked."""
LISTEN_S: Final = 0.02
"""How often a running search looks for messages of its clients."""


def serve_plans(bus: Bus, make_plans: MakePlans, stop: threading.Event) -> None:
    """Announce this planner and answer requests until `stop`; a planner that fails answers `failed`.

    Raises:
        RecordingError: The planner plays a recording, and was asked for something else.
    """
    with StatusBeacon(bus) as beacon:
        server = _Server(bus, make_plans, stop)
        bus.announce()
        while not stop.is_set():
            server.listen()
            if case := server.queue.next_case():
                beacon.publish_status("planning", detail=case)
                server.work()
            else:
                beacon.publish_status("idle")
                server.wait()


class _Server:
    """A request queue, fed from the bus, and the way back of its answers."""

    def __init__(self, bus: Bus, make_plans: MakePlans, stop: threading.Event) -> None:
        self.queue = RequestQueue(
            make_plans, lambda name, incarnation: bus.liveliness.is_live("agent", name, incarnation)
        )
        self._bus = bus
        self._stop = stop
        self._requests = bus.subscribe(channels.plan_requests(bus.run, "*"))
        self._cancels = bus.subscribe(channels.plan_cancels(bus.run, "*"))
        self._publishers: dict[str, Publisher[PlanResult]] = {}
        self._listened_at = monotonic()

    def wait(self) -> None:
        """For a request, but not for long."""
        request = self._requests.next(IDLE_S)
        if request is not None:
            self._send(self.queue.ask(request) or ())

    def listen(self) -> None:
        """Take in what came; answer what can be answered at once."""
        self._listened_at = monotonic()
        for request in self._requests.drain():
            answers = self.queue.ask(request)
            if answers is None:
                old = f"request {request.request_id} of {request.header.name} is not its newest"
                self._bus.tally.add("superseded", old, logging.INFO)
            self._send(answers or ())
        for cancel in self._cancels.drain():
            self._send(self.queue.cancel(cancel))

    def work(self) -> None:
        """On the next answer."""
        answer = self.queue.work(self._interrupted)
        if answer is not None:
            self._send([answer])

    def _interrupted(self) -> bool:
        if monotonic() - self._listened_at < LISTEN_S:
            return False
        self.listen()
        return self._stop.is_set() or self.queue.should_stop()

    def _send(self, answers: Iterable[Answer]) -> None:
        for answer in answers:
            if answer.client not in self._publishers:
                self._publishers[answer.client] = self._bus.publisher(
                    channels.plan_results(self._bus.run, answer.client)
                )
            self._publishers[answer.client].send(_address(answer))


def _address(answer: Answer) -> Callable[[Header], PlanResult]:
    """The answer as a message."""
    return lambda header: PlanResult(
        header=header,
        client_incarnation=answer.incarnation,
        request_id=answer.request_id,
        revision=answer.revision,
        final=answer.final,
        plan=answer.plan,
    )
