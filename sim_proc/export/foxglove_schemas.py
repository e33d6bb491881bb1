"""JSON Schemas of the messages without a schema of Foxglove's: the numbers to plot, and the steps."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from sim_proc.export.columns import Column


def _schema(title: str, fields: Mapping[str, tuple[str, str, str]]) -> dict[str, Any]:
    """JSON Schema of a flat message, from type, description and unit of each field. Unknown values are left out."""
    properties = {
        name: {"type": kind, "description": about + (f" [{unit}]" if unit else "")}
        for name, (kind, about, unit) in fields.items()
    }
    return {"title": title, "type": "object", "properties": properties}


STEP_SCHEMA: Final = _schema(
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
        "box_friction": ("number", "friction of box and floor from here on", ""),
        "box_foot_friction": ("number", "friction of box and foot from here on", ""),
    },
)
"""A step of the episode: a motion, and the fields of that motion."""


STRING_SCHEMA: Final = _schema("std_msgs/String", {"data": ("string", "the robot as URDF", "")})
"""The message from which Foxglove reads a URDF, called as in ROS."""


def signals_schema(columns: Sequence[Column]) -> dict[str, Any]:
    """Schema of a row of these columns."""
    return _schema("legpush.Signals", {each.name: (_json_type(each), each.about, each.unit) for each in columns})


def _json_type(column: Column) -> str:
    return "integer" if column.values.dtype.kind == "i" else "number"
