"""Compares our planners with planners of other projects, by the same exact test at the same clearance.

All take turns on the same maps. Ours return a smooth path with headings, theirs return corners. The time is that from
the query to the path, including the map. `pip install 'legpush[bench]'` installs the others; python_motion_planning is
under the GPL.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache, partial
from itertools import product
from time import perf_counter
from typing import Final

from msgspec.structs import replace

from agent_proc.statistics.intervals import ORDER_STATISTICS
from agent_proc.statistics.paired import common
from benchmarks.planners.maps import question
from benchmarks.planners.measures import measured, points_of
from benchmarks.planners.peers_plot import draw
from benchmarks.planners.tables import RESULTS, Row, fill, numbers, spread
from experiments.evaluations import read_table, write_table
from legpush.arrays import Floats
from legpush.messages.planning import TrunkPathQuery
from legpush.scene.names import PlannerName
from legpush.scene.scenario import Anytime, Smoothing
from planner_proc.planning import make_plans
from planner_proc.smoothing import polylines

Planner = Callable[[TrunkPathQuery, int], Floats | None]

TABLE: Final = RESULTS / "planner_peers_runs.csv.gz"
SUMMARY: Final = RESULTS / "planner_peers.csv"
MAPS: Final = ("published", "published_detour", "around a wall", "maze", "random 1", "random 3")
OURS: Final[tuple[PlannerName, ...]] = ("rrt_connect", "rrt", "rrt_star")
REFERENCE: Final = "legpush rrt_connect"
NOT_SMOOTHED: Final = Smoothing(method="none")
"""Leaves the corners, as the others do, but shortens the path."""
AS_SHORT: Final = "python_motion_planning RRT* until as short"
"""Label of the planner that continues until its path is as short as that of the reference with the same seed."""
LONG_MAPS: Final = ("published", "around a wall")
N_LONG: Final = 5


@dataclass(frozen=True, kw_only=True)
class Peers:
    """Compare with planners of other projects.

    With NUMBA_DISABLE_JIT=1 in the environment, python_motion_planning runs as pure Python; a second call adds those
    rows.
    """

    n_seeds: int = 20
    """Number of seeds for each planner on each map."""


def main(config: Peers) -> None:
    """Measure what is not in the table yet, then summarize and draw."""
    planners = _planners()
    for name, planner in product(MAPS, planners.values()):
        # The first call compiles code and fills caches, which is not measured.
        if not _is_long(planner):
            planner(question(name), config.n_seeds)
    wanted = [
        (label, name, seed)
        for seed, name, (label, planner) in product(range(config.n_seeds), MAPS, planners.items())
        if not _is_long(planner) or (name in LONG_MAPS and seed < N_LONG)
    ]

    def measure(label: str, name: str, seed: int) -> Row:
        if _is_long(planners[label]):
            _length_m(question(name), seed)
        begin_s = perf_counter()
        points_m = planners[label](question(name), seed)
        row: Row = {"seconds": round(perf_counter() - begin_s, 6), "found": points_m is not None}
        if points_m is None:
            return row | {"length_m": "", "clearance_m": "", "curvature_rms_per_m": "", "keeps_clearance": ""}
        measures = asdict(measured(question(name), points_m))
        return row | {key: round(value, 5) if isinstance(value, float) else value for key, value in measures.items()}

    rows = fill(TABLE, ("planner", "map", "seed"), wanted, measure)
    summary = [_summary(label, name, rows) for name in MAPS for label in dict.fromkeys(row["planner"] for row in rows)]
    write_table(summary, SUMMARY)
    for row in read_table(SUMMARY):
        print("  ".join(f"{value:>24s}" if key in ("planner", "map") else f"{value:>9s}" for key, value in row.items()))
    draw(rows, RESULTS / "planner_peers.png")


def _planners() -> dict[str, Planner]:
    """Return the planners by their labels in the table, ours first."""
    from benchmarks.planners import peer_planners as peers

    numba = "Numba" if peers.COMPILED else "pure Python"
    return {
        **{f"legpush {name}": partial(_ours, planner=name) for name in OURS},
        f"{REFERENCE}, not smoothed": partial(_ours, planner="rrt_connect", smoothing=NOT_SMOOTHED),
        f"python_motion_planning RRT, {numba}": partial(peers.motion_planning, star=False),
        f"python_motion_planning RRT*, {numba}": partial(peers.motion_planning, star=True),
        f"{AS_SHORT}, {numba}": partial(peers.motion_planning, star=True, until=_length_m),
        "pathplanning rrt, C": partial(peers.path_planning, planner="rrt"),
        "pathplanning rrt_connect, C": partial(peers.path_planning, planner="rrt_connect"),
    }


def _is_long(planner: Planner) -> bool:
    return isinstance(planner, partial) and planner.keywords.get("until") is not None


@cache
def _length_m(query: TrunkPathQuery, seed: int) -> float:
    """Return the length of the path of the reference, or 0 without one."""
    points_m = _ours(query, seed, planner="rrt_connect")
    return 0.0 if points_m is None else polylines.length(points_m)


def _ours(
    query: TrunkPathQuery, seed: int, *, planner: PlannerName, smoothing: Smoothing | None = None
) -> Floats | None:
    """Return the points of the first exact path of one of our planners."""
    anytime = Anytime(n_improvements=1, improvement_iterations=1) if planner == "rrt_star" else None
    asked = replace(query, planner=planner, seed=seed, anytime=anytime, smoothing=smoothing or query.smoothing)
    plan = next(make_plans(asked, lambda: False))
    return points_of(plan) if plan.status == "exact" else None


def _summary(label: str, name: str, rows: list[Row]) -> Row:
    """Summarize one planner on one map, with its times and lengths over those of the reference with the same seed."""
    here = [row for row in rows if (row["planner"], row["map"]) == (label, name)]
    found = [row for row in here if row["found"] == "True"]
    ours = [row for row in rows if (row["planner"], row["map"], row["found"]) == (REFERENCE, name, "True")]
    return {
        "map": name,
        "planner": label,
        "n": len(here),
        "found": len(found),
        "keeps_clearance": sum(row["keeps_clearance"] == "True" for row in found),
        "ms": spread(numbers(found, "seconds"), 1e3),
        "times_as_slow": spread(_ratios(found, ours, "seconds")),
        "length_m": spread(numbers(found, "length_m"), digits=2),
        "times_as_long": spread(_ratios(found, ours, "length_m"), digits=3),
        "curvature_rms_per_m": spread(numbers(found, "curvature_rms_per_m"), digits=2),
        "interval": f"of medians, {ORDER_STATISTICS}",
    }


def _ratios(rows: list[Row], others: list[Row], key: str) -> list[float]:
    """Return the ratios of a measure of the seeds that both have."""
    first, second = ({row["seed"]: float(row[key]) for row in some} for some in (rows, others))
    return [one / other for one, other in common(first, second)]
