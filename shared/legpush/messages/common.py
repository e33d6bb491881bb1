"""The header of every message, and types that several messages use."""

from typing import Annotated, Final, Literal

from msgspec import Meta, Struct

from legpush.fields import Name

PROTOCOL_VERSION: Final = 6

Role = Literal["planner", "sim", "agent", "launcher", "recorder"]
ROLES: Final[tuple[Role, ...]] = ("planner", "sim", "agent")
"""The three processes of a mission."""
MAX_COUNT: Final = 2**53
"""Largest count: up to here readers of JSON keep every integer."""
Count = Annotated[int, Meta(ge=0, le=MAX_COUNT)]
TimeNs = Annotated[int, Meta(ge=0, le=2**63 - 1)]
"""A time in nanoseconds since 1970, up to the year 2262. It takes more than 53 bits."""
Unit = Annotated[float, Meta(ge=0.0, le=1.0)]

MAX_WAYPOINTS: Final = 100_000
MAX_DEPTH_M: Final = 0.25
"""Deepest push."""
USUAL_DEPTH_M: Final = 0.05
"""Depth of the pushes that the push model was fitted to."""


class Header(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Names the sender of a message and the run that it belongs to."""

    protocol: Count
    run: Name
    role: Role
    name: Name
    incarnation: Name
    """A random name that a process draws when it starts: a restarted process has another one."""
    sequence: Count
    """Number of this message among those that the incarnation published under this key, from 0. A gap shows that a
    message was lost, a repeat that one was duplicated."""
