"""Turning circles of boxes without a push map: measured by 24 pushes, guessed, and after four pushes of the robot."""

from math import radians
from typing import Final

import numpy as np
from msgspec.structs import replace

from agent_proc.figures import Figure, legend_below
from agent_proc.push_model.map import Sample, make_push_map
from agent_proc.push_model.model import NOMINAL
from experiments.rows import Row, Rows, read_rows
from experiments.tables.parts import as_csv, as_json, errors_of, kinds_of, made_of

COLORS: Final = {"measured": "black", "guessed": "#c8553d", "after four pushes": "#3a6ea5"}
N_DIGITS: Final = 4
GOOD_SHARE: Final = 0.12


def _read() -> dict[str, Rows]:
    return {name: read_rows(name) for name in ("unknown_boxes", "own_estimates")}


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = _read()
    table = _table(studies)
    guessed = [abs(row["guessed_m"] / row["radius_m"] - 1.0) for row in table]
    own = [abs(row["own_m"] / row["radius_m"] - 1.0) for row in table]
    numbers = {
        "n": len(table),
        "n_boxes": len({row["box"] for row in table}),
        "largest_share_guessed": max(guessed),
        "largest_share_own": max(own),
        "good_share": GOOD_SHARE,
        "n_good_own": sum(share < GOOD_SHARE for share in own),
    }
    return {"unknown_boxes.csv": as_csv(table), "unknown_boxes.json": as_json(made_of(**studies), numbers)}


def _table(studies: dict[str, Rows]) -> list[Row]:
    """Return a row for each box and face."""
    measured: dict[tuple[str, str], list[Row]] = {}
    for row in studies["unknown_boxes"].rows:
        box = {name: row[f"box.{name}"] for name in ("size_m", "mass_kg", "friction", "shape")}
        measured.setdefault((_name(box), row["face"]), []).append(row | {"box": box})
    own: dict[tuple[str, str], list[Row]] = {}
    for row in studies["own_estimates"].rows:
        own.setdefault((_name(row), row["face"]), []).append(row)
    return [_row(*key, rows, own[key]) for key, rows in measured.items()]


def _name(box: Row) -> str:
    """Name a box by what differs from the nominal one."""
    length_m, width_m, _ = box["size_m"]
    if box["shape"] == "cylinder":
        return f"cylinder, {length_m:g} m"
    if tuple(box["size_m"]) != NOMINAL.size_m:
        return f"{length_m:g} x {width_m:g} m"
    words = [f"{box['mass_kg']:g} kg"] * (box["mass_kg"] != NOMINAL.mass_kg)
    words += [f"friction {box['friction']:g}"] * (box["friction"] != NOMINAL.friction)
    return ", ".join(words) or "default"


def _row(name: str, face: str, measured: list[Row], own: list[Row]) -> Row:
    samples = [sample for row in measured for sample in _samples(row)]
    changes = measured[0]["box"] | {"size_m": tuple(measured[0]["box"]["size_m"])}
    (circle,) = make_push_map(replace(NOMINAL, **changes), samples, "").circles
    own_m = [row["own_m"] for row in own]
    return {
        "box": name,
        "face": face,
        **circle.radius_m.columns("radius_m", N_DIGITS),
        "axle_m": circle.axle_m.value,
        "guessed_m": round(own[0]["guessed_m"], N_DIGITS),
        "own_m": round(float(np.mean(own_m)), N_DIGITS),
        "own_sd_m": round(float(np.std(own_m, ddof=1)), N_DIGITS),
    }


def _samples(row: Row) -> list[Sample]:
    """Return the pushes of a series."""
    return [
        Sample(
            face=row["face"],
            leg=leg,
            w1=row["w1"],
            w2=row["w2"],
            depth_m=row["depth_m"],
            forward_m=forward_m,
            left_m=left_m,
            turn_rad=radians(turn_deg),
        )
        for leg, forward_m, left_m, turn_deg in zip(
            row["legs"], row["each_forward_m"], row["each_left_m"], row["each_turn_deg"], strict=True
        )
    ]


def pictures() -> dict[str, Figure]:
    """Draw a line for each box and face."""
    rows = _table(_read())
    figure = Figure(figsize=(8.6, 0.36 * len(rows) + 1.2), layout="constrained", dpi=120)
    axis = figure.subplots()
    at = np.arange(len(rows))[::-1]
    radius, reach = errors_of(rows, "radius_m")
    label = f"measured by 24 pushes, {kinds_of(rows, 'radius_m')}"
    axis.errorbar(radius, at, xerr=reach, fmt="s", ms=5, capsize=3, color=COLORS["measured"], label=label)
    axis.plot([one["guessed_m"] for one in rows], at, "x", ms=7, color=COLORS["guessed"], label="guessed")
    own, sd = np.array([one["own_m"] for one in rows]), np.array([one["own_sd_m"] for one in rows])
    color, label = COLORS["after four pushes"], "after four pushes, ± sd"
    axis.errorbar(own, at - 0.22, xerr=sd, fmt="o", ms=4, capsize=2, color=color, label=label)
    axis.set_yticks(at, [f"{one['box']}, {one['face']} face" for one in rows])
    axis.set(xlabel="turning radius of the point that does not slip sideways [m]", xlim=(0.0, None))
    axis.grid(axis="x", color="#e6e8eb")
    legend_below(axis, n_columns=1)
    return {"unknown_boxes.png": figure}
