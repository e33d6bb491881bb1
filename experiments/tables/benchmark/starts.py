"""Starts beside the goal's line and turned: how far from it pushes still bring the box to its goal."""

from math import cos, radians, sin
from typing import Any, Final

import numpy as np

from agent_proc.figures import Figure
from agent_proc.statistics.intervals import mean, mean_of_groups, share
from agent_proc.statistics.paired import paired_difference
from experiments.rows import Row, has_rows, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain

POLICIES: Final = ("random", "alternate", "constant", "scripted", "variable", "wide", "dynamic_programming")
WIDE: Final = ("wide_starts", "wide_starts_blind")
"""Studies of starts that are drawn; the second one has the first of them alone."""
TRAININGS: Final = "training_wide"
"""Study of trainings like that of `wide`, each judged from the first of these starts."""
BOX_M: Final = (6.0, 6.0)
"""Where the box of the scenario `open` stands, with the heading 0."""
MEASURES: Final = ("position_error_m", "angle_error_deg", "n_cycles")
FAR_M: Final = 0.05
"""A box that ends farther from its goal was lost."""
TUBES: Final = ((0.10, 25.0), (0.15, 20.0), (0.20, 30.0))
"""Offsets and headings within which every start of the map is counted."""
MOST_CM: Final = 5.0
"""Where the colours of the picture end."""


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = {name: read_rows(name) for name in ("start_map", *WIDE, TRAININGS) if has_rows(name)}
    wide = [row for name in WIDE if name in studies for row in studies[name].rows]
    starts = _map()
    numbers = {
        "trainings": _of_trainings(studies[TRAININGS].rows) if TRAININGS in studies else {},
        "wide": {policy: _of_policy(wide, policy) for policy in POLICIES if any(r["policy"] == policy for r in wide)},
        "map": {
            policy: {
                f"{off_m:g} m, {heading_deg:g}°": _within(rows, off_m, heading_deg) for off_m, heading_deg in TUBES
            }
            for policy, rows in _by_policy(starts).items()
        },
    }
    return {"starts.csv": as_csv(starts), "starts.json": as_json(made_of(**studies), numbers)}


def pictures() -> dict[str, Figure]:
    """Draw where the box ended, over its offset and heading at the start."""
    policies = _by_policy(_map())
    figure = Figure(figsize=(5.2 * len(policies), 4.2), layout="constrained", dpi=110)
    panels = figure.subplots(1, len(policies), sharey=True, squeeze=False)[0]
    for axes, (policy, rows) in zip(panels, policies.items(), strict=True):
        headings, offsets = (sorted({row[name] for row in rows}) for name in ("heading_deg", "offset_m"))
        errors_cm = np.full((len(headings), len(offsets)), np.nan)
        for row in rows:
            at = headings.index(row["heading_deg"]), offsets.index(row["offset_m"])
            errors_cm[at] = 100 * row["position_error_m"]
            if not row["success"]:
                axes.plot(100 * row["offset_m"], row["heading_deg"], "x", color="white", markersize=7)
        image = axes.pcolormesh(100 * np.array(offsets), headings, errors_cm, vmin=0.0, vmax=MOST_CM, cmap="cividis")
        axes.set_title(policy)
        axes.set_xlabel("offset to the left at the start [cm]")
    panels[0].set_ylabel("heading at the start [deg]")
    figure.colorbar(image, ax=panels, label="position error at the end [cm]", extend="max")
    figure.suptitle("Starts 1 m before the goal, one episode each; a cross: not within 3 cm and 3°")
    return {"start_map.png": figure}


def place_of(row: Row) -> tuple[float, float]:
    """Return offset to the left [m] and heading [deg] of the box at the start, in the frame of its goal."""
    yaw_rad = radians(row["goal.pose.yaw_deg"])
    x_m, y_m = BOX_M[0] - row["goal.pose.x_m"], BOX_M[1] - row["goal.pose.y_m"]
    return round(-sin(yaw_rad) * x_m + cos(yaw_rad) * y_m, 3), -row["goal.pose.yaw_deg"]


def _map() -> list[Row]:
    """Return the rows of the map, with offset and heading."""
    found = []
    for row in read_rows("start_map").rows:
        offset_m, heading_deg = place_of(row)
        kept = {name: row[name] for name in ("ending", "success", *MEASURES)}
        found.append({"policy": row["policy"], "offset_m": offset_m, "heading_deg": heading_deg, **kept})
    return found


def _by_policy(rows: list[Row]) -> dict[str, list[Row]]:
    return {
        policy: [row for row in rows if row["policy"] == policy] for policy in dict.fromkeys(r["policy"] for r in rows)
    }


def _within(rows: list[Row], off_m: float, heading_deg: float) -> dict[str, Any]:
    """Count the successes among the starts within an offset and a heading."""
    here = [row for row in rows if abs(row["offset_m"]) <= off_m and abs(row["heading_deg"]) <= heading_deg]
    return {
        "n": len(here),
        "successes": sum(row["success"] for row in here),
        "largest_position_error_m": max(row["position_error_m"] for row in here),
    }


def _of_trainings(rows: list[Row]) -> dict[str, Any]:
    """Return their CPU times, how often they succeed, and the mean error, each training being one value."""
    cpu_s = [row["cpu_s"] for row in rows]
    return {
        "n": len(rows),
        "least_cpu_s": min(cpu_s),
        "largest_cpu_s": max(cpu_s),
        "n_starts": sum(len(row["final_success"]) for row in rows),
        "successes": sum(sum(row["final_success"]) for row in rows),
        "position_error_m": plain(mean_of_groups([row["final_position_error_m"] for row in rows]).cut(0.0), 7),
    }


def _of_policy(rows: list[Row], policy: str) -> dict[str, Any]:
    here = [row for row in rows if row["policy"] == policy]
    rival = {row["seed"]: row for row in rows if row["policy"] == "scripted"}
    n_successes = sum(row["success"] for row in here)
    return {
        "n": len(here),
        "successes": n_successes,
        "success_rate": plain(share(n_successes, len(here)), 4),
        "n_lost": sum(row["position_error_m"] > FAR_M for row in here),
        "largest_position_error_m": max(row["position_error_m"] for row in here),
        **{name: plain(mean([float(row[name]) for row in here]), 7) for name in MEASURES},
        "minus_scripted": {
            name: plain(
                paired_difference(
                    {row["seed"]: float(row[name]) for row in here},
                    {row["seed"]: float(rival[row["seed"]][name]) for row in here},
                ),
                7,
            )
            for name in MEASURES
            if policy != "scripted"
        },
    }
