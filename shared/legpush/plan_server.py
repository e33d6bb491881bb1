"""The planner's end: a request is answered once and the answer repeated on demand; a client's newest request wins."""

import logging
import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import Final, NamedTuple

from legpush import channels
from legpush.bus import Bus, Publisher
from legpush.messages import Header, Plan, PlanQuery, PlanRequest, PlanResult
from legpush.status import StatusBeacon

IDLE_S: Final = 0.1
"""The stop event is looked at this often."""
MAX_CLIENTS: Final = 64
"""Answers are kept for this many clients, the least recently served is forgotten first."""

MakePlan = Callable[[PlanQuery], Plan]


class Answered(NamedTuple):
    """The last request of a client that was answered."""

    incarnation: str
    request_id: int
    query: PlanQuery
    plan: Plan


class PlanDesk:
    """Decides on requests, without I/O; the state is the last answer to each client."""

    def __init__(self, make_plan: MakePlan) -> None:
        self._make_plan = make_plan
        self._answered: OrderedDict[str, Answered] = OrderedDict()

    def answer(self, request: PlanRequest) -> Plan | None:
        """The plan, newly made or repeated; None for a request older than the last one that was answered."""
        client, incarnation = request.header.name, request.header.incarnation
        last = self._answered.get(client)
        if last is not None and last.incarnation == incarnation:
            if request.request_id < last.request_id:
                return None
            if request.request_id == last.request_id:
                if request.query == last.query:
                    return last.plan
                return Plan(status="invalid", reason=f"request id {last.request_id} was used for another query before")
        plan = self._make_plan(request.query)
        self._answered[client] = Answered(incarnation, request.request_id, request.query, plan)
        self._answered.move_to_end(client)
        if len(self._answered) > MAX_CLIENTS:
            self._answered.popitem(last=False)
        return plan


def serve_plans(bus: Bus, make_plan: MakePlan, stop: threading.Event) -> None:
    """Announce this planner and answer requests until `stop`; an error of the planner's own is raised."""
    requests = bus.subscribe(channels.plan_requests(bus.run, "*"))
    publishers: dict[str, Publisher[PlanResult]] = {}
    desk = PlanDesk(make_plan)
    with StatusBeacon(bus) as status:
        bus.announce()
        waiting: list[PlanRequest] = []
        while not stop.is_set():
            if not waiting:
                first = requests.next(IDLE_S)
                if first is None:
                    continue
                waiting = newest_per_client([first, *requests.drain()])
            request = waiting.pop(0)
            client = request.header.name
            status.say("planning", detail=f"request {request.request_id} of {client}")
            plan = desk.answer(request)
            if plan is None:
                bus.tally.add("superseded", f"request {request.request_id} of {client} is not its newest", logging.INFO)
            else:
                if client not in publishers:
                    publishers[client] = bus.publisher(channels.plan_results(bus.run, client))
                publishers[client].send(_address(request, plan))
            came_meanwhile = [other for other in requests.drain() if not _same_question(other, request)]
            waiting = newest_per_client([*waiting, *came_meanwhile])
            status.say("idle")


def newest_per_client(requests: list[PlanRequest]) -> list[PlanRequest]:
    """Of each client the request with the highest id of its latest incarnation, in order of first arrival."""
    newest: dict[str, PlanRequest] = {}
    for request in requests:
        known = newest.get(request.header.name)
        same_client = known is not None and known.header.incarnation == request.header.incarnation
        if known is None or not same_client or request.request_id >= known.request_id:
            newest[request.header.name] = request
    return list(newest.values())


def _same_question(one: PlanRequest, other: PlanRequest) -> bool:
    """Whether one is a copy of the other; those that came while it was answered need no answer of their own."""
    return (one.header.incarnation, one.request_id, one.query) == (
        other.header.incarnation,
        other.request_id,
        other.query,
    )


def _address(request: PlanRequest, plan: Plan) -> Callable[[Header], PlanResult]:
    """The plan as a message to whoever asked."""
    return lambda header: PlanResult(
        header=header, client_incarnation=request.header.incarnation, request_id=request.request_id, plan=plan
    )
