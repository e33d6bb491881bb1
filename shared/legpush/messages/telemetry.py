"""Messages for people and recorders; the lockstep never waits for them."""

from typing import Annotated

from msgspec import Meta, Struct

from legpush.bounds import Count, Reading, TimeNs, Unit
from legpush.fields import Name
from legpush.messages.common import Header, Role


class Status(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a process is doing, for people, and what a simulator computes with, for those who join it."""

    header: Header
    phase: str
    """What the process is doing, such as `walking`."""
    fraction: Unit | None = None
    """Share of the phase that is done, if it is known."""
    detail: str = ""
    """The same in more words, such as how far the robot has walked."""
    waiting_for: str = ""
    """The peer that the process waits for; empty if it does not wait."""
    numerics: str = ""
    """What a simulator computes with, such as `x86-64-v3/1a2b3c4d, motions 4`: equal ones lead to equal states."""


class RewardTerm(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One term of a reward."""

    name: Name
    value: Reading


class Reward(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The reward of a step, for people; the lockstep does not depend on it."""

    header: Header
    sim: Name
    """The simulator that took the step."""
    episode: Count
    step: Count
    value: Reading
    """The sum of the terms."""
    terms: tuple[RewardTerm, ...]


class Copy(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A published message, byte for byte."""

    key: str
    sequence: Count
    """The `sequence` of its header."""
    time_ns: TimeNs
    """When it was published, in nanoseconds since 1970."""
    payload: bytes


class Published(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How many messages were published under a key."""

    key: str
    n: Count
    """The sequence of the next message under this key."""
    since: Count
    """This batch and later ones hold the messages under this key from this sequence on, except lost ones. Earlier
    messages were in earlier batches, or were published while nobody recorded."""


class Fact(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A file for the recording, such as a scenario that a process works with or a report that it wrote."""

    name: Annotated[str, Meta(pattern=r"^[A-Za-z0-9_.-]{1,64}$(?!\n)")]
    media_type: str
    data: bytes


class Origin(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The process whose messages are copied."""

    role: Role
    name: Name
    incarnation: Name


class Copies(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A batch of copies of what a process published, in that order. It is sent again until a recorder answers with
    `Taken`."""

    header: Header
    origin: Origin
    """The process that published the messages: the sender itself, or the one that it hands copies over for."""
    batch: Count
    """Number of the batch among those of the origin, from 0; the next one follows when this one is taken."""
    copies: tuple[Copy, ...]
    published: tuple[Published, ...]
    """One entry for every key that the origin has used. A message that is in no batch is lost to recorders."""
    facts: tuple[Fact, ...]
    final: bool
    """Whether the origin ends: no batch follows."""


class Taken(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Says that a recorder has this batch."""

    header: Header
    origin_incarnation: Name
    batch: Count
