"""All planners of legpush, straight and steered: success, time, length, clearance and smoothness."""

from typing import Final

from agent_proc.figures import Figure
from agent_proc.statistics.intervals import mean, median, share
from benchmarks.planners.maps import MAPS
from benchmarks.tables.compare_picture import draw
from benchmarks.tables.rows import numbers, rows_of
from experiments.rows import Row, Rows
from experiments.tables.parts import as_csv, as_json, made_of, plain

STATISTICS: Final = (
    ("first_s", median),
    ("final_s", median),
    ("first_length_m", mean),
    ("length_m", mean),
    ("times_shortest", mean),
    ("clearance_m", mean),
    ("curvature_rms_per_m", mean),
)


def _read() -> Rows:
    """Read the rows, and add each length over the shortest path that any planner found on that map."""
    study = rows_of("planner_compare")
    shortest_m = {name: min(numbers(study.where(map=name), "length_m")) for name in MAPS}
    for row in study.rows:
        row["times_shortest"] = None if row["length_m"] is None else row["length_m"] / shortest_m[row["map"]]
    return study


def _table(study: Rows) -> list[Row]:
    variants = dict.fromkeys((row["planner"], row["steering"]) for row in study.rows)
    return [_summary(planner, steering, name, study) for planner, steering in variants for name in ("all", *MAPS)]


def _summary(planner: str, steering: str, name: str, study: Rows) -> Row:
    """Summarize one planner on one map, or on `all` maps."""
    here = [row for row in study.where(planner=planner, steering=steering) if name in ("all", row["map"])]
    good = [row for row in here if row["status"] == "exact"]
    found: Row = {
        "planner": planner,
        "steering": steering,
        "map": name,
        "n": len(here),
        **share(len(good), len(here)).columns("success", 4),
        "colliding": sum(row["keeps_clearance"] is False for row in good),
    }
    for key, statistic in STATISTICS:
        found |= statistic(numbers(good, key)).columns(key, 5)
    return found


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = _read()
    by_variant: Row = {}
    for planner, steering in dict.fromkeys((row["planner"], row["steering"]) for row in study.rows):
        here = study.where(planner=planner, steering=steering)
        good = [row for row in here if row["status"] == "exact"]
        by_variant[planner if steering == "straight" else f"{planner}, {steering}"] = {
            "n": len(here),
            "exact": len(good),
            **{key: plain(statistic(numbers(good, key)), 7) for key, statistic in STATISTICS},
        }
    made = made_of(planner_compare=study)
    return {
        "planner_compare.csv": as_csv(_table(study)),
        "planner_compare.json": as_json(made, {"planners": by_variant}),
    }


def pictures() -> dict[str, Figure]:
    """Draw every map separately."""
    return {"planner_compare.png": draw(_table(_read()))}
