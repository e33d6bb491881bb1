"""What a push does to boxes of different size, mass and friction, by depth and curve.

Each row of the table is over the same series of left and right pushes from three random starts; right pushes are
mirrored. `PushModel` contains the rows at 0.1 kg, friction 0.5 and w1 = w2 = 0.5.
"""

from typing import Final

import numpy as np

from agent_proc.push_model.model import MIRROR
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_csv, as_json, made_of
from legpush.arrays import Floats

PUSHES: Final = ("box.size_m", "box.mass_kg", "box.friction", "w1", "w2")
"""Inputs apart from depth and seed."""


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows("push_effect")
    groups: dict[str, dict[float, list[Row]]] = {}
    for row in study.rows:
        by_depth = groups.setdefault(repr([row[name] for name in PUSHES]), {})
        by_depth.setdefault(row["depth_m"], []).append(row)
    table = [_row(rows) for by_depth in groups.values() for rows in by_depth.values()]
    numbers = {
        "n": len(study.rows),
        "shortest_s": min(row["longest_s"] for row in table),
        "longest_s": max(row["longest_s"] for row in table),
        "largest_depth_m": max(row["depth_m"] for row in table),
    }
    return {"push_effect.csv": as_csv(table), "push_effect.json": as_json(made_of(push_effect=study), numbers)}


def _row(rows: list[Row]) -> Row:
    """Return means and standard deviations over the pushes of some series."""
    first = rows[0]
    moved = np.concatenate([_moved(row) for row in rows])
    mean, spread = moved.mean(axis=0), moved.std(axis=0, ddof=1)
    return {
        "length_m": first["box.size_m"][0],
        "width_m": first["box.size_m"][1],
        "mass_kg": first["box.mass_kg"],
        "friction": first["box.friction"],
        "w1": first["w1"],
        "w2": first["w2"],
        "depth_m": first["depth_m"],
        "n": len(moved),
        "forward_m": round(mean[0], 4),
        "forward_sd_m": round(spread[0], 4),
        "left_m": round(mean[1], 4),
        "left_sd_m": round(spread[1], 4),
        "turn_deg": round(mean[2], 2),
        "turn_sd_deg": round(spread[2], 2),
        "largest_tilt_deg": round(max(row["max_abs_tilt_deg"] for row in rows), 2),
        "least_margin_m": round(min(row["min_support_margin_m"] for row in rows), 4),
        "longest_s": round(max(row["longest_push_s"] for row in rows), 2),
    }


def _moved(row: Row) -> Floats:
    """Return how far each push moves the box forward and to the left and turns it, as of FL, (n, 3)."""
    mirror = np.array([MIRROR[leg] for leg in row["legs"]])
    return np.column_stack([row["each_forward_m"], mirror * row["each_left_m"], mirror * row["each_turn_deg"]])
