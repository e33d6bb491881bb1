"""Compares all planners, straight and steered, on golden and random maps: success, time, length, clearance,
smoothness."""

from dataclasses import asdict, dataclass
from itertools import product
from time import perf_counter
from typing import Any, Final

from msgspec.structs import replace

from agent_proc.statistics.intervals import mean, median, share
from benchmarks.planners.compare_plot import draw
from benchmarks.planners.maps import MAPS, question
from benchmarks.planners.measures import measured, points_of
from benchmarks.planners.random_requests import PLANNERS
from benchmarks.planners.tables import RESULTS, Row, fill, numbers, spread
from experiments.evaluations import write_table
from legpush.messages.planning import Plan
from legpush.scene.scenario import Anytime
from planner_proc.planning import make_plans

TABLE: Final = RESULTS / "planner_compare.csv.gz"
SUMMARY: Final = RESULTS / "planner_compare.csv"
VARIANTS: Final = (
    *((planner, "straight") for planner in PLANNERS),
    ("rrt_star", "dubins"),
    ("bit_star", "dubins"),
    ("rrt_connect", "reeds_shepp"),
    ("rrt_star", "reeds_shepp"),
)
RADIUS_M: Final = 0.4
"""Turning radius of the steered planners."""
BUDGET: Final = 3000
IMPROVEMENTS: Final = Anytime(n_improvements=3, improvement_iterations=300)
STEERED_BUDGET: Final = 600
STEERED_IMPROVEMENTS: Final = Anytime(n_improvements=3, improvement_iterations=60)
"""The budget is smaller because an iteration with curves takes many times as long."""


@dataclass(frozen=True, kw_only=True)
class Compare:
    """Run every planner on every map, with equal budgets of iterations."""

    n_seeds: int = 20
    """Number of seeds for each planner on each map."""


def main(config: Compare) -> None:
    """Measure what is not in the table yet, then summarize and draw."""
    # The seeds are the outer loop, so that other work on the machine affects all planners equally.
    wanted = [
        (planner, steering, name, seed)
        for seed, name, (planner, steering) in product(range(config.n_seeds), MAPS, VARIANTS)
    ]
    rows = fill(TABLE, ("planner", "steering", "map", "seed"), wanted, _measure)
    shortest_m = _shortest_m(rows)
    for row in rows:
        row["times_shortest"] = float(row["length_m"]) / shortest_m[row["map"]] if row["length_m"] else ""
    summary = [
        _summary(planner, steering, name, rows) for (planner, steering), name in product(VARIANTS, ("all", *MAPS))
    ]
    write_table(summary, SUMMARY)
    _print(rows)
    draw(summary, RESULTS / "planner_compare.png")


def _measure(planner: str, steering: str, name: str, seed: int) -> Row:
    """Plan one request with improvements and time each answer; return a row of the table."""
    straight = steering == "straight"
    changes: dict[str, Any] = {
        "planner": planner,
        "steering": steering,
        "seed": seed,
        "max_iterations": BUDGET if straight else STEERED_BUDGET,
        "anytime": IMPROVEMENTS if straight else STEERED_IMPROVEMENTS,
        "min_turning_radius_m": 0.0 if straight else RADIUS_M,
    }
    query = replace(question(name), **changes)
    plans: list[Plan] = []
    times_s: list[float] = []
    begin_s = perf_counter()
    for plan in make_plans(query, lambda: False):
        plans.append(plan)
        times_s.append(perf_counter() - begin_s)
    exact = [k for k, plan in enumerate(plans) if plan.status == "exact"]
    row: Row = {"status": plans[-1].status, "first_s": "", "final_s": round(times_s[-1], 5), "first_length_m": ""}
    empty = {"length_m": "", "clearance_m": "", "curvature_rms_per_m": "", "keeps_clearance": ""}
    if not exact:
        return row | empty
    row |= {"first_s": round(times_s[exact[0]], 5), "first_length_m": round(plans[exact[0]].length_m, 4)}
    measures = asdict(measured(query, points_of(plans[-1])))
    return row | {key: round(value, 5) if isinstance(value, float) else value for key, value in measures.items()}


def _summary(planner: str, steering: str, name: str, rows: list[Row]) -> Row:
    """Summarize one planner on one map, or on `all` maps."""
    here = [
        row for row in rows if (row["planner"], row["steering"]) == (planner, steering) and name in ("all", row["map"])
    ]
    good = [row for row in here if row["status"] == "exact"]
    found: Row = {
        "planner": planner,
        "steering": steering,
        "map": name,
        "n": len(here),
        **share(len(good), len(here)).columns("success", 4),
        "colliding": sum(row["keeps_clearance"] == "False" for row in good),
    }
    for key, statistic in (
        ("first_s", median),
        ("final_s", median),
        ("first_length_m", mean),
        ("length_m", mean),
        ("times_shortest", mean),
        ("clearance_m", mean),
        ("curvature_rms_per_m", mean),
    ):
        found |= statistic(numbers(good, key)).columns(key, 5)
    return found


def _shortest_m(rows: list[Row]) -> dict[str, float]:
    """Return, for each map, the length of the shortest path that any planner found with any seed."""
    return {name: min(numbers((row for row in rows if row["map"] == name), "length_m")) for name in MAPS}


def _print(rows: list[Row]) -> None:
    """Print a line per planner, over all maps."""
    titles = ("exact".rjust(7), *(title.ljust(22) for title in ("first [ms]", "final [ms]", "length / shortest")))
    print(" ".join((" " * 26, *titles, "RMS curvature [1/m]")))
    for planner, steering in VARIANTS:
        here = [row for row in rows if (row["planner"], row["steering"]) == (planner, steering)]
        good = [row for row in here if row["status"] == "exact"]
        relative = numbers(good, "times_shortest")
        columns = (
            f"{planner}, {steering}".ljust(26),
            f"{len(good)}/{len(here)}".rjust(7),
            spread(numbers(good, "first_s"), 1e3).ljust(22),
            spread(numbers(good, "final_s"), 1e3, 0).ljust(22),
            f"{mean(relative):.3f}".ljust(22),
            spread(numbers(good, "curvature_rms_per_m"), digits=2),
        )
        print(" ".join(columns))
