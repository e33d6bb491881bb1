"""What processes say for people and recorders; the lockstep never waits for it."""

from typing import Annotated

from msgspec import Meta, Struct

from legpush.fields import Name
from legpush.messages.common import Count, Header, Role, Unit


class Status(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a process is doing, for people to watch; the protocol never depends on it."""

    header: Header
    phase: str
    fraction: Unit | None = None
    """Share of the phase that is done, where it is known."""
    detail: str = ""
    waiting_for: str = ""
    """Whom the process waits for, if it does."""


class RewardTerm(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A part of a reward."""

    name: Name
    value: float


class Reward(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a step earned, for people to watch; the lockstep never depends on it."""

    header: Header
    sim: Name
    """The simulator that took the step."""
    episode: Count
    step: Count
    value: float
    """The sum of the terms."""
    terms: tuple[RewardTerm, ...]


class Copy(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A message that was published, byte for byte."""

    key: str
    sequence: Count
    """Of its header."""
    time_ns: Count
    """When it was published, since 1970."""
    payload: bytes


class Published(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How much was published under a key."""

    key: str
    n: Count
    """The sequence of the next message under this key."""
    since: Count
    """This batch and those after it have the messages under this key from this sequence on, but for what is lost: those
    before it were in other batches, or published when nobody recorded."""


class Fact(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A file that a recording should have: what a process works with, or what came of it."""

    name: Annotated[str, Meta(pattern=r"^[A-Za-z0-9_.-]{1,64}$(?!\n)")]
    media_type: str
    data: bytes


class Origin(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Whose messages are copied: those of this incarnation."""

    role: Role
    name: Name
    incarnation: Name


class Copies(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Copies of what a process published, in that order, for recorders; sent again until it is `Taken`."""

    header: Header
    origin: Origin
    """The sender itself, or in a replay whom it stands for."""
    batch: Count
    """Counts the origin's batches, from 0; the next one comes when this one is taken."""
    copies: tuple[Copy, ...]
    published: tuple[Published, ...]
    """Of every key that this origin has used: what is not among the copies of any batch is lost to recorders."""
    facts: tuple[Fact, ...]
    final: bool
    """Whether the origin ends: nothing follows."""


class Taken(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A recorder has this batch."""

    header: Header
    origin_incarnation: Name
    batch: Count
