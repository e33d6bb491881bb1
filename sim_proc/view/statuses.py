"""Human-readable state of each process of a run at a given time."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from legpush.history.run_history import Said
from legpush.messages.common import ROLES, Role
from legpush.messages.telemetry import Origin

SILENT_S: Final = 3.0
"""A process without a status for this long counts as silent. Statuses come at least once a second."""

Health = Literal["alive", "silent", "gone"]


@dataclass(frozen=True, kw_only=True)
class Condition:
    """State of one process."""

    role: Role
    name: str
    health: Health
    """`silent`: alive, but without a recent status. `gone`: not alive, or not seen yet."""
    phase: str = ""
    detail: str = ""
    waiting_for: str = ""


def conditions(said: Sequence[Said], time_ns: int, live: Collection[Origin] | None) -> list[Condition]:
    """State of every process that was heard up to a time, with at least one process of each role.

    `live` are the processes that are alive now. Without it, as in a recording, a process without a status in the last
    `SILENT_S` before that time is gone.
    """
    last: dict[tuple[Role, str], Said] = {}
    for each in said:
        if each.time_ns <= time_ns:
            last[each.origin.role, each.origin.name] = each
    names = {(role, name) for role, name in last if role in ROLES}
    names |= {(origin.role, origin.name) for origin in live or () if origin.role in ROLES}
    names |= {(role, "main") for role in ROLES if all(role != known for known, _ in names)}
    ordered = sorted(names, key=lambda each: (ROLES.index(each[0]), each[1]))
    return [_condition(role, name, last.get((role, name)), time_ns, live) for role, name in ordered]


def _condition(role: Role, name: str, said: Said | None, time_ns: int, live: Collection[Origin] | None) -> Condition:
    is_fresh = said is not None and (time_ns - said.time_ns) / 1e9 <= SILENT_S
    is_there = is_fresh if live is None else any((each.role, each.name) == (role, name) for each in live)
    health: Health = "gone" if not is_there else "alive" if is_fresh else "silent"
    if said is None:
        return Condition(role=role, name=name, health=health)
    status = said.status
    return Condition(
        role=role,
        name=name,
        health=health,
        phase=status.phase,
        detail=status.detail,
        waiting_for=status.waiting_for,
    )
