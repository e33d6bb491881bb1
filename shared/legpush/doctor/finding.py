"""What a check of the machine found."""

from typing import Literal

from msgspec import Struct

State = Literal["ok", "note", "missing"]
"""`note`: something is left out or differs, but a mission runs; `missing`: no mission can run."""


class Finding(Struct, frozen=True, kw_only=True):
    """One line of `legpush doctor`."""

    name: str
    state: State
    detail: str
    """What was found."""
    cure: str = ""
    """What would change it, if it is not `ok`."""
