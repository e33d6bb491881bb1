"""The entries of a journal: what was asked, and what was answered."""

from typing import Final

from msgspec import Struct

from legpush.bounds import Count
from legpush.fields import Name
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome

JOURNAL_VERSION: Final = 2


class Opened(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="opened"):
    """The first entry: which episode of which run this is."""

    journal_version: int = JOURNAL_VERSION
    protocol: int
    run: Name
    seed: Count
    versions: dict[str, str]
    """Package to version, of the agent that began the episode."""
    began_unix_s: float


class Numbered(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="numbered"):
    """From here on the simulator knows the episode by this number."""

    episode: Count


class Acted(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="acted"):
    """An action that is about to be sent."""

    motion: Motion
    with_trace: bool


class Observed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="observed"):
    """What the action before led to."""

    outcome: Outcome


class Refused(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="refused"):
    """The action before cannot be carried out; the state is as it was."""

    reason: str


class Queried(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="queried"):
    """A plan query that is about to be sent."""

    query: PlanQuery


class Awaited(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="awaited"):
    """A better plan for the last query is waited for."""

    revision: Count


class Planned(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="entry", tag="planned"):
    """The plan that answers the query before, or the better one that was waited for."""

    plan: Plan


Entry = Opened | Numbered | Acted | Observed | Refused | Queried | Awaited | Planned


class AnyEntry(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What one frame holds."""

    e: Entry
