"""What all messages have in common: the header, and types with their bounds."""

from typing import Annotated, Final, Literal

from msgspec import Meta, Struct

from legpush.fields import Name

PROTOCOL_VERSION: Final = 6

Role = Literal["planner", "sim", "agent", "launcher", "recorder"]
ROLES: Final[tuple[Role, ...]] = ("planner", "sim", "agent")
"""The three processes of a mission."""
Count = Annotated[int, Meta(ge=0)]
Unit = Annotated[float, Meta(ge=0.0, le=1.0)]

MAX_WAYPOINTS: Final = 100_000
MAX_DEPTH_M: Final = 0.25
"""Deepest push."""
USUAL_DEPTH_M: Final = 0.05
"""Depth of the pushes that the push model is fitted to."""


class Header(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Who says it, in which run."""

    protocol: int
    run: Name
    role: Role
    name: Name
    incarnation: Name
    """Drawn anew each time the process starts: a restarted peer is another one."""
    sequence: Count
    """Counts what this incarnation published under this key, from 0; a gap or a repeat shows loss or duplication."""
