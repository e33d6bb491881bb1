"""What checks have at hand, and the question that most of them ask."""

from dataclasses import dataclass
from typing import Final

from planner_proc.conformance.cases import query, room
from planner_proc.conformance.client import Client, PlannerProcess

START_S: Final = 20.0
"""A planner has so long to come up."""
REMARK: Final = "remark: "
"""What begins so is worth saying, and no fault."""
EASY: Final = query(room(8.0, 6.0, (3.9, 4.1, 0.0, 4.4)), (1.0, 1.0), (7.0, 1.0))


@dataclass(frozen=True, kw_only=True)
class Bench:
    """What checks work with."""

    planner: PlannerProcess
    client: Client
    other: Client
    deadline_s: float
