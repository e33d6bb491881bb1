"""Makes the JSON Schemas of the messages, for documentation and recordings."""

from typing import Any, Final

import msgspec
from msgspec import Struct

from legpush.messages import planning, stepping, telemetry
from legpush.messages.common import PROTOCOL_VERSION

MESSAGES: Final[tuple[type[Struct], ...]] = (
    planning.PlanRequest,
    planning.PlanCancel,
    planning.PlanResult,
    stepping.Action,
    stepping.Observation,
    stepping.Refusal,
    telemetry.Status,
    telemetry.Copies,
    telemetry.Taken,
    telemetry.Reward,
)
"""The records that travel as messages of their own."""


def json_schema(*kinds: type[Struct]) -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of a message that is one of these kinds; binary fields are base64 there."""
    (schema,), definitions = msgspec.json.schema_components(
        [kinds[0] if len(kinds) == 1 else _union(kinds)], ref_template="#/$defs/{name}"
    )
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"legpush protocol {PROTOCOL_VERSION}: {' or '.join(kind.__name__ for kind in kinds)}",
        **schema,
        "$defs": definitions,
    }


def _union(kinds: tuple[type[Struct], ...]) -> Any:
    union: Any = kinds[0]
    for kind in kinds[1:]:
        union |= kind
    return union
