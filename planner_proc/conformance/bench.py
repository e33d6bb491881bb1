"""What every check works with: the planner, its clients, and the query that most checks ask."""

from dataclasses import dataclass
from typing import Final

from planner_proc.conformance.cases import query, room
from planner_proc.conformance.client import Client, PlannerProcess

START_S: Final = 20.0
"""Longest time that a planner may take to start."""
REMARK: Final = "remark: "
"""Prefix of a reason that is worth printing but is not a fault."""
EASY: Final = query(room(8.0, 6.0, (3.9, 4.1, 0.0, 4.4)), (1.0, 1.0), (7.0, 1.0))
"""A query that every planner should answer quickly: around the end of a wall."""


@dataclass(frozen=True, kw_only=True)
class Bench:
    """The planner that is checked, and two clients that ask it."""

    planner: PlannerProcess
    client: Client
    other: Client
    """A second client, which asks at the same time."""
    deadline_s: float
    """Longest time that an answer may take."""
