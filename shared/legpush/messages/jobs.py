"""What the head of a study asks a worker to compute, and what the worker answers."""

from typing import Literal

from msgspec import Struct

from legpush.bounds import Count
from legpush.fields import Name
from legpush.messages.common import Header


class JobRequest(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Asks a worker to run cells of a study. Equal requests of one head are one job, which is done once."""

    header: Header
    number: Count
    """Number of the job among those that this head sends this worker, from 0."""
    job: bytes
    """The cells as MessagePack, and what code and canary the worker must have."""


class JobResult(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The answer to the job with this number of this head."""

    header: Header
    head_incarnation: Name
    number: Count
    ending: Literal["answered", "lost"]
    """`lost` means that the process that ran the cells died."""
    answer: bytes
    """The rows as MessagePack; empty if the job was lost."""
    reason: str = ""
    """Why it was lost."""
