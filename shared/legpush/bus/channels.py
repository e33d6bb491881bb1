"""The channels of a run, in one table: which key carries which message, who may speak there, and how it is sent."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar, cast

from legpush.bus import keys
from legpush.messages.common import Header, Role
from legpush.messages.jobs import JobRequest, JobResult
from legpush.messages.planning import PlanCancel, PlanRequest, PlanResult
from legpush.messages.stepping import Action, Answer, Observation, Refusal
from legpush.messages.telemetry import Copies, Reward, Status, Taken

Message = (
    PlanRequest | PlanCancel | PlanResult | Action | Answer | JobRequest | JobResult | Reward | Status | Copies | Taken
)

M = TypeVar("M", bound=Message)

Quality = Literal["lockstep", "tap"]
"""`lockstep` never drops a message on a living link, `tap` drops rather than delay anything."""


@dataclass(frozen=True, kw_only=True)
class Channel(Generic[M]):
    """One kind of message under one key, which may hold wildcards for subscribers."""

    key: str
    kind: type[M]
    sender: Role | None
    """The only role that may speak here; None for any."""
    key_of: Callable[[Header], str] | None = None
    """The key that the sender named in a header has to use, where the key names the sender."""
    quality: Quality = "lockstep"
    is_copied: bool = True
    """Whether recorders get copies of it."""


def actions(run: str, sim: str) -> Channel[Action]:
    """What the agent wants the simulator `sim` to do."""
    return Channel(key=keys.action(run, sim), kind=Action, sender="agent")


def answers(run: str, sim: str) -> Channel[Answer]:
    """What the simulator `sim` answers."""
    kind = cast(type[Answer], Observation | Refusal)
    return Channel(
        key=keys.observation(run, sim),
        kind=kind,
        sender="sim",
        key_of=lambda header: keys.observation(run, header.name),
    )


def plan_requests(run: str, client: str) -> Channel[PlanRequest]:
    """What `client`, or `*` for all of them, asks the planner."""
    return Channel(
        key=keys.plan_request(run, client),
        kind=PlanRequest,
        sender="agent",
        key_of=lambda header: keys.plan_request(run, header.name),
    )


def plan_cancels(run: str, client: str) -> Channel[PlanCancel]:
    """What `client`, or `*` for all of them, no longer asks the planner."""
    return Channel(
        key=keys.plan_cancel(run, client),
        kind=PlanCancel,
        sender="agent",
        key_of=lambda header: keys.plan_cancel(run, header.name),
    )


def plan_results(run: str, client: str) -> Channel[PlanResult]:
    """What the planner answers `client`."""
    return Channel(key=keys.plan_result(run, client), kind=PlanResult, sender="planner")


def job_requests(run: str, worker: str) -> Channel[JobRequest]:
    """What the heads of studies ask a worker to compute."""
    return Channel(key=keys.job_request(run, worker), kind=JobRequest, sender="agent", is_copied=False)


def job_results(run: str, worker: str) -> Channel[JobResult]:
    """What a worker answers."""
    return Channel(
        key=keys.job_result(run, worker),
        kind=JobResult,
        sender="worker",
        key_of=lambda header: keys.job_result(run, header.name),
        is_copied=False,
    )


def rewards(run: str, sim: str) -> Channel[Reward]:
    """What the steps of the simulator `sim` earned, for people."""
    return Channel(key=keys.reward(run, sim), kind=Reward, sender="agent", quality="tap")


def statuses(run: str, role: Role | Literal["*"] = "*", name: str = "*") -> Channel[Status]:
    """What a process, or `*` for all of them, tells people about its work."""
    return Channel(
        key=keys.status(run, role, name),
        kind=Status,
        sender=None,
        key_of=lambda header: keys.status(run, header.role, header.name),
        quality="tap",
    )


def copies(run: str, role: Role | Literal["*"] = "*", name: str = "*") -> Channel[Copies]:
    """What a process, or `*` for all of them, hands to recorders."""
    return Channel(
        key=keys.copies(run, role, name),
        kind=Copies,
        sender=None,
        key_of=lambda header: keys.copies(run, header.role, header.name),
        quality="tap",
        is_copied=False,
    )


def taken(run: str, role: Role, name: str) -> Channel[Taken]:
    """What recorders tell a process that they have."""
    return Channel(key=keys.taken(run, role, name), kind=Taken, sender="recorder", quality="tap", is_copied=False)
