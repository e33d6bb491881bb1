"""Pushes along the curves of both loci of Eq. 15, and along Bezier curves of degree 1 to 5 (Eq. 14)."""

from collections.abc import Callable, Sequence
from typing import Any, Final

from agent_proc.statistics.intervals import mean, share
from experiments.rows import Row, Rows, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain

LOW_WAY_M: Final = 0.03
"""A foot that moves farther within 5 mm of the floor goes along it: a foot that rises needs a few millimetres."""
USUAL_DEPTH_M: Final = 0.05
MEASURES: Final = (
    "forward_m",
    "left_m",
    "turn_deg",
    "peak_force_n",
    "max_box_speed_m_s",
    "low_way_m",
    "highest_m",
    "way_m",
    "contact_height_m",
    "contact_speed_m_s",
    "contact_rise_deg",
    "max_push_moment_n_m",
)
N_DIGITS: Final = 5


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    loci, degrees, close_up = (read_rows(name) for name in ("push_loci", "push_degrees", "close_up"))
    by_locus = _grouped(loci.rows, lambda row: (row["box_height_m"], row["locus"]))
    by_weights = _grouped(degrees.rows, lambda row: (row["depth_m"], len(row["weights"]) + 1, curve_name(row)))
    by_degree = _grouped(_usual(degrees), lambda row: row["degree"])
    numbers = {
        "loci": {
            f"{height_m:g} m": {
                locus: _numbers(rows) for (height, locus), rows in by_locus.items() if height == height_m
            }
            for height_m in dict.fromkeys(row["box_height_m"] for row in loci.rows)
        },
        "degrees": {str(degree): _numbers(rows) for degree, rows in by_degree.items()},
        "tops": {
            str(degree): _numbers([row for row in rows if curve_name(row) in ("chord", "all 0.5")])
            for degree, rows in by_degree.items()
        },
    }
    loci_table = [
        {"box_height_m": height_m, "locus": locus, **_columns(rows)} for (height_m, locus), rows in by_locus.items()
    ]
    degrees_table = [
        {"depth_m": depth_m, "degree": degree, "weights": name, **_columns(rows)}
        for (depth_m, degree, name), rows in by_weights.items()
    ]
    return {
        "push_loci.csv": as_csv(loci_table),
        "push_degrees.csv": as_csv(degrees_table),
        "push_curves.json": as_json(made_of(push_loci=loci, push_degrees=degrees, close_up=close_up), numbers),
    }


def curve_name(row: Row) -> str:
    """Say where the inner control points of a curve are on their locus."""
    weights = row["weights"]
    if not weights:
        return "chord"
    if len(set(weights)) == 1:
        return f"all {weights[0]:g}"
    return "even"


def _usual(study: Rows) -> list[Row]:
    return study.where(depth_m=USUAL_DEPTH_M)


def _grouped(rows: Sequence[Row], key: Callable[[Row], Any]) -> dict[Any, list[Row]]:
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def _numbers(rows: list[Row]) -> Row:
    """Return counts, and the mean of each measure with its interval and its extremes."""
    done = [row for row in rows if not row["refused"]]
    low = sum(row["low_way_m"] > LOW_WAY_M for row in done)
    raised = sum(row["n_raised"] > 0 for row in done)
    found: Row = {
        "n": len(rows),
        "refused": len(rows) - len(done),
        "falls": sum(row["fell"] for row in done),
        "along_floor": low,
        "along_floor_share": plain(share(low, len(done)), N_DIGITS),
        "raised": raised,
        "raised_share": plain(share(raised, len(done)), N_DIGITS),
        "lowest_asked_m": min(row["lowest_asked_m"] for row in done),
    }
    for name in MEASURES:
        values = [row[name] for row in done if row[name] is not None]
        found[name] = {"mean": plain(mean(values), N_DIGITS), "least": min(values), "largest": max(values)}
    return found


def _columns(rows: list[Row]) -> Row:
    """Return the same as columns of a table."""
    numbers = _numbers(rows)
    columns: Row = {name: numbers[name] for name in ("n", "refused", "falls", "along_floor", "raised")}
    columns["lowest_asked_m"] = round(numbers["lowest_asked_m"], N_DIGITS)
    for name in MEASURES:
        estimate = numbers[name]["mean"]
        columns |= {name: estimate["value"], f"{name}_low": estimate["low"], f"{name}_high": estimate["high"]}
    return columns | {"interval": numbers["forward_m"]["mean"]["kind"]}
