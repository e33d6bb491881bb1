"""The agent's end of planning: one query at a time, answered by whichever planner lives."""

import threading
from dataclasses import replace
from typing import Final

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.exchange import Exchange, OnWait, no_report
from legpush.messages.planning import Plan, PlanCancel, PlanQuery, PlanRequest, PlanResult
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
        self._cancels = bus.publisher(channels.plan_cancels(bus.run, bus.name))
        patience = replace(patience or Patience(), resend_at_most_s=RESEND_AT_MOST_S)
        self._exchange = Exchange(bus, results, ("planner", None), patience, stop, on_wait)
        self._request_id = -1
        self._query: PlanQuery | None = None
        self._plans: dict[int, Plan] = {}
        self._final = True

    def plan(self, query: PlanQuery) -> Plan:
        """The planner's first answer; `PeerError` past the deadline."""
        self._request_id += 1
        self._query, self._plans, self._final = query, {}, False
        return self._revision(0)

    def revision(self, revision: int, query: PlanQuery | None) -> Plan:
        """The answer with this number to the last query, which is asked again where it was not asked by this process;
        the last answer if there are no more. `PeerError` past the deadline.
        """
        if query is not None and query != self._query:
            self.plan(query)
        return self._revision(revision)

    def _revision(self, revision: int) -> Plan:
        self._exchange.offer_answers(self._keep)
        if not self._has(revision):
            what = f"plan request {self._request_id}" + (f", revision {revision}" if revision else "")
            self._exchange.ask(what, self._send, lambda result: self._keep(result) and self._has(revision))
            self._exchange.forgive_restarts()
        return self._plans[min(revision, max(self._plans))]

    def cancel(self) -> None:
        """No more answers to the last query are wanted; where the planner misses that, it costs only its time."""
        if not self._final:
            self._final = True
            self._cancels.send(lambda header: PlanCancel(header=header, request_id=self._request_id))

    def _has(self, revision: int) -> bool:
        return revision in self._plans or (self._final and revision > max(self._plans, default=revision))

    def _send(self) -> None:
        if (query := self._query) is not None:
            request_id = self._request_id
            self._requests.send(lambda header: PlanRequest(header=header, request_id=request_id, query=query))

    def _keep(self, result: PlanResult) -> bool:
        """Take in an answer to the last query; whether it is one."""
        if (result.client_incarnation, result.request_id) != (self._bus.incarnation, self._request_id):
            return False
        self._plans[result.revision] = result.plan
        self._final = self._final or result.final
        return True
