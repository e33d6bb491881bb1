"""JSON Schemas of the messages that have no type of Foxglove's."""

from collections.abc import Mapping
from typing import Any, Final

from sim_proc.export.columns import Column


def json_type(column: Column) -> str:
    return "integer" if column.values.dtype.kind == "i" else "number"


def flat_schema(title: str, fields: Mapping[str, tuple[str, str, str]]) -> dict[str, Any]:
    """JSON Schema of a flat message, from type, description and unit of each field. Unknown values are left out."""
    properties = {
        name: {"type": kind, "description": about + (f" [{unit}]" if unit else "")}
        for name, (kind, about, unit) in fields.items()
    }
    return {"title": title, "type": "object", "properties": properties}


STEP_SCHEMA: Final = flat_schema(
    "legpush.Step",
    {
        "step": ("integer", "number of the step in the episode", ""),
        "motion": ("string", "reset, follow, walk, push or alter", ""),
        "reward": ("number", "reward of the step", ""),
        "leg": ("string", "leg that pushes", ""),
        "face": ("string", "pushed face of the box", ""),
        "locus": ("string", "curve along which w1 and w2 run", ""),
        "w1": ("number", "place of the first inner control point", ""),
        "w2": ("number", "place of the second inner control point", ""),
        "depth_m": ("number", "how far beyond the face the curve ends", "m"),
        "box_mass_kg": ("number", "mass of the box from here on", "kg"),
        "box_friction": ("number", "friction of the box from here on", ""),
    },
)
