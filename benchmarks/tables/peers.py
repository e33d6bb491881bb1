"""Planners of legpush and of other projects: times and lengths over those of our `rrt_connect` with the same seed."""

from agent_proc.figures import Figure
from agent_proc.statistics.intervals import ORDER_STATISTICS, median
from agent_proc.statistics.paired import common
from benchmarks.planners.peers import UNTIL
from benchmarks.tables.peers_picture import draw
from benchmarks.tables.rows import numbers, rows_of, spread
from experiments.rows import Row, Rows
from experiments.tables.parts import as_csv, as_json, made_of, plain

REFERENCE = "legpush rrt_connect"
STUDIES = ("planner_peers", "planner_peers_pure", "planner_peers_until")


def _read() -> dict[str, Rows]:
    """Read the rows, and add how the code of each planner runs to its name."""
    studies = {name: rows_of(name) for name in STUDIES}
    for study in studies.values():
        for row in study.rows:
            row["planner"] += _how(row)
    return studies


def _how(row: Row) -> str:
    if row["planner"].startswith("python_motion_planning"):
        return ", Numba" if row["compiled"] else ", pure Python"
    return ", C" if row["planner"].startswith("pathplanning") else ""


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = _read()
    rows = [row for study in studies.values() for row in study.rows]
    maps, labels = (list(dict.fromkeys(row[key] for row in rows)) for key in ("map", "planner"))
    table = [_summary(label, name, rows) for name in maps for label in labels]
    ratios = {
        name: {
            label: {
                f"times_{key}": plain(median(_ratios(rows, name, label, column)), 3)
                for key, column in (("as_slow", "seconds"), ("as_long", "length_m"))
            }
            for label in labels
        }
        for name in maps
    }
    until = [row for row in rows if row["planner"].startswith(UNTIL)]
    long = {"n": len(until), "found": sum(row["found"] for row in until)}
    return {
        "planner_peers.csv": as_csv([row for row in table if row["n"]]),
        "planner_peers.json": as_json(made_of(**studies), {"maps": ratios, "until_as_short": long}),
    }


def _summary(label: str, name: str, rows: list[Row]) -> Row:
    """Summarize one planner on one map."""
    here = [row for row in rows if (row["planner"], row["map"]) == (label, name)]
    found = [row for row in here if row["found"]]
    return {
        "map": name,
        "planner": label,
        "n": len(here),
        "found": len(found),
        "keeps_clearance": sum(row["keeps_clearance"] for row in found),
        "ms": spread(numbers(found, "seconds"), 1e3),
        "times_as_slow": spread(_ratios(rows, name, label, "seconds")),
        "length_m": spread(numbers(found, "length_m"), digits=2),
        "times_as_long": spread(_ratios(rows, name, label, "length_m"), digits=3),
        "curvature_rms_per_m": spread(numbers(found, "curvature_rms_per_m"), digits=2),
        "interval": f"of medians, {ORDER_STATISTICS}",
    }


def _ratios(rows: list[Row], name: str, label: str, key: str) -> list[float]:
    """Return the ratios of a measure of a planner and of the reference, of the seeds that both have."""
    found = [row for row in rows if row["map"] == name and row["found"]]
    first, second = (
        {row["seed"]: row[key] for row in found if row["planner"] == planner} for planner in (label, REFERENCE)
    )
    return [one / other for one, other in common(first, second)]


def pictures() -> dict[str, Figure]:
    """Draw time over length."""
    return {"planner_peers.png": draw([row for study in _read().values() for row in study.rows])}
