"""The header of every message, and types that several messages use."""

from typing import Final, Literal

from msgspec import Struct

from legpush.bounds import Count
from legpush.fields import Name

PROTOCOL_VERSION: Final = 10
READABLE_VERSIONS: Final = (6, 7, 8, 9, 10)
"""Protocol versions of recordings that can be read: each message of an older one is one of the present version."""

Role = Literal["planner", "sim", "agent", "worker", "launcher", "recorder"]
ROLES: Final[tuple[Role, ...]] = ("planner", "sim", "agent")
"""The three processes of a mission."""
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
