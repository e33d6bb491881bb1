"""The agent's end of planning: one query at a time, answered by whichever planner lives."""

import threading
from dataclasses import replace
from typing import Final

from legpush import channels
from legpush.bus import Bus
from legpush.exchange import Exchange, OnWait, no_report
from legpush.messages import Plan, PlanQuery, PlanRequest
from legpush.patience import Patience

RESEND_AT_MOST_S: Final = 2.0
"""A query carries a map of up to megabytes, and they queue up while the planner plans: not too often."""


class PlanLink:
    """Asks the planner; a planner that is restarted meanwhile is asked again and gives the same plan."""

    def __init__(
        self, bus: Bus, *, stop: threading.Event, patience: Patience | None = None, on_wait: OnWait = no_report
    ) -> None:
        self._bus = bus
        results = bus.subscribe(channels.plan_results(bus.run, bus.name))
        self._requests = bus.publisher(channels.plan_requests(bus.run, bus.name))
        patience = replace(patience or Patience(), resend_at_most_s=RESEND_AT_MOST_S)
        self._exchange = Exchange(bus, results, ("planner", None), patience, stop, on_wait)
        self._n_asked = 0

    def plan(self, query: PlanQuery) -> Plan:
        """The planner's answer; `PeerError` past the deadline."""
        request_id = self._n_asked
        self._n_asked += 1
        result = self._exchange.ask(
            f"plan request {request_id}",
            lambda: self._requests.send(
                lambda header: PlanRequest(header=header, request_id=request_id, query=query),
            ),
            lambda result: (result.client_incarnation, result.request_id) == (self._bus.incarnation, request_id),
        )
        self._exchange.settle()
        return result.plan
