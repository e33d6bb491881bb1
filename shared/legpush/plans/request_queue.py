"""Which request a planner works on, and what it answers: decisions alone, without a bus.

A request is answered once and the answers are repeated on demand; a client's newest request wins, and an incarnation
of a client that is alive is not displaced by another one of its name. First answers come before improvements. A search
that has to make way starts over later: equal queries get equal plans, so the answers that were sent already are
skipped.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from legpush.messages.planning import Plan, PlanCancel, PlanQuery, PlanRequest, TrunkPathQuery
from legpush.plans.planner import Interrupted, MakePlans, PlanningInterruptedError
from legpush.plans.search import search_plans

MAX_CLIENTS: Final = 64
"""Answers are kept for this many clients. Those that are gone are forgotten first, then the least recently served."""

IsLive = Callable[[str, str], bool]
"""Whether the client with this name and incarnation is still there."""


def is_gone(_name: str, _incarnation: str) -> bool:
    """Say that every earlier incarnation of a client is gone."""
    return False


class Answer(NamedTuple):
    """An answer to a client."""

    client: str
    incarnation: str
    request_id: int
    revision: int
    final: bool
    plan: Plan


@dataclass(kw_only=True)
class _Case:
    """The newest request of a client."""

    client: str
    incarnation: str
    request_id: int
    query: PlanQuery | None
    """None where it was cancelled before it came."""
    plans: list[Plan] = field(default_factory=list)
    final: bool = False

    def answers(self) -> list[Answer]:
        """All answers up to now."""
        return [self.answer(revision) for revision in range(len(self.plans))]

    def answer(self, revision: int) -> Answer:
        """One of them."""
        final = self.final and revision == len(self.plans) - 1
        return Answer(self.client, self.incarnation, self.request_id, revision, final, self.plans[revision])


class RequestQueue:
    """The newest request of each client, and the search for the one at hand."""

    def __init__(self, make_plans: MakePlans, is_live: IsLive = is_gone) -> None:
        """`is_live` says whether an incarnation of a client still wants answers when another one asks."""
        self._make_plans = make_plans
        self._is_live = is_live
        self._cases: OrderedDict[tuple[str, str], _Case] = OrderedDict()
        self._at_hand: _Case | None = None
        self._search: Iterator[Plan] = iter(())

    def ask(self, request: PlanRequest) -> list[Answer] | None:
        """What is answered at once; None for a request older than its client's newest."""
        header = request.header
        case = self._case(header.name, header.incarnation, request.request_id)
        if case is None:
            return None
        if case.request_id != request.request_id:
            self._open(header.name, header.incarnation, request.request_id, request.query)
            return []
        if case.query is None or case.query == request.query:
            return case.answers()
        reason = f"request id {case.request_id} was used for another query before"
        invalid = Plan(status="invalid", reason=reason)
        return [Answer(case.client, case.incarnation, case.request_id, 0, True, invalid)]

    def cancel(self, cancel: PlanCancel) -> list[Answer]:
        """The last answer to the request that is cancelled: the best found so far, or the status `cancelled`."""
        header = cancel.header
        case = self._case(header.name, header.incarnation, cancel.request_id)
        if case is None:
            return []
        if case.request_id != cancel.request_id:
            case = self._open(header.name, header.incarnation, cancel.request_id, None)
        if not case.plans:
            case.plans.append(Plan(status="cancelled", reason="Cancelled before there was a plan"))
        case.final = True
        return [case.answer(len(case.plans) - 1)]

    def next_case(self) -> str:
        """The request to work on, in words; empty if there is none."""
        case = self._next()
        return f"request {case.request_id} of {case.client}" if case is not None else ""

    def should_stop(self) -> bool:
        """Whether the search at hand has to make way."""
        return self._at_hand is not self._next()

    def work(self, interrupted: Interrupted) -> Answer | None:
        """The next answer, of the request whose turn it is; None where the search had to make way."""
        case = self._next()
        if case is None or case.query is None:
            return None
        try:
            if case is not self._at_hand:
                self._at_hand, self._search = case, search_plans(self._make_plans, case.query, interrupted)
                for _ in case.plans:
                    next(self._search, None)
            plan = next(self._search, None)
        except PlanningInterruptedError:
            self._at_hand = None
            return None
        if plan is not None:
            case.plans.append(plan)
        case.final = plan is None or plan.status == "invalid" or len(case.plans) > _n_improvements(case.query)
        return case.answer(len(case.plans) - 1)

    def _case(self, client: str, incarnation: str, request_id: int) -> _Case | None:
        """The client's newest request unless it is newer than this one; of a new client one that never was."""
        case = self._cases.get((client, incarnation))
        if case is None:
            return _Case(client=client, incarnation=incarnation, request_id=-1, query=None)
        return None if request_id < case.request_id else case

    def _open(self, client: str, incarnation: str, request_id: int, query: PlanQuery | None) -> _Case:
        """Take in a new request, and forget those of earlier incarnations of its client that are gone."""
        case = _Case(client=client, incarnation=incarnation, request_id=request_id, query=query)
        for name, other in tuple(self._cases):
            if name == client and (other == incarnation or not self._is_live(name, other)):
                del self._cases[name, other]
        self._cases[client, incarnation] = case
        if len(self._cases) > MAX_CLIENTS:
            del self._cases[next((key for key in self._cases if not self._is_live(*key)), next(iter(self._cases)))]
        return case

    def _next(self) -> _Case | None:
        """The one without an answer that came first; else the one at hand, else any that can be improved."""
        waiting = [case for case in self._cases.values() if not case.final]
        if self._at_hand in waiting and self._at_hand is not None and not self._at_hand.plans:
            return self._at_hand
        unanswered = [case for case in waiting if not case.plans]
        if unanswered:
            return unanswered[0]
        return self._at_hand if self._at_hand in waiting else next(iter(waiting), None)


def _n_improvements(query: PlanQuery) -> int:
    """How many revisions follow the first."""
    anytime = query.anytime if isinstance(query, TrunkPathQuery) else None
    return anytime.n_improvements if anytime is not None else 0
