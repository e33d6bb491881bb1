"""Draws the comparison of planners: a panel per measure, a row per map, a mark per planner."""

from math import isfinite
from typing import Final

from agent_proc.figures import Figure
from experiments.rows import Row
from experiments.tables.parts import errors_of, kinds_of

PANELS: Final = (
    ("success", "exact paths, share", False),
    ("first_s", "time to the first exact path [s], median", True),
    ("final_s", "time with three improvements [s], median", True),
    ("times_shortest", "length over the shortest found on that map, mean", False),
    ("clearance_m", "least clearance [m], mean", False),
    ("curvature_rms_per_m", "RMS curvature [1/m], mean", False),
)
COLORS: Final = {
    "rrt": "#b04a4a",
    "rrt_connect": "#2b6f9e",
    "rrt_star": "#3f8f4f",
    "informed_rrt_star": "#8a5fb0",
    "bit_star": "#c9822b",
    "prm_star": "#555555",
}
MARKS: Final = {"straight": "o", "dubins": "^", "reeds_shepp": "D"}


def draw(summary: list[Row]) -> Figure:
    """Draw every map separately, with 95 % intervals."""
    maps = [name for name in dict.fromkeys(row["map"] for row in summary) if name != "all"]
    variants = list(dict.fromkeys((row["planner"], row["steering"]) for row in summary))
    figure = Figure(figsize=(15.0, 13.0), layout="constrained", dpi=80)
    axes = figure.subplots(2, 3, sharey=True)
    for axis, (key, label, logarithmic) in zip(axes.flat, PANELS, strict=True):
        shown = [row for row in summary if row["map"] != "all" and isfinite(row[key])]
        for place, (planner, steering) in enumerate(variants):
            rows = [row for row in shown if (row["planner"], row["steering"]) == (planner, steering)]
            at = [maps.index(row["map"]) + 0.8 * (place / (len(variants) - 1) - 0.5) for row in rows]
            middle, reach = errors_of(rows, key)
            axis.errorbar(
                middle,
                at,
                xerr=reach,
                fmt=MARKS[steering],
                color=COLORS[planner],
                markerfacecolor=COLORS[planner] if steering == "straight" else "white",
                markersize=4.5,
                linewidth=1.0,
                label=planner if steering == "straight" else f"{planner}, {steering}",
            )
        axis.set_xlabel(f"{label}\n{kinds_of(shown, key)}")
        if logarithmic:
            axis.set_xscale("log")
        elif key != "times_shortest":
            axis.set_xlim(left=0.0)
        axis.grid(alpha=0.25, axis="x")
        for border in range(1, len(maps)):
            axis.axhline(border - 0.5, color="#cccccc", linewidth=0.6)
    for axis in axes[:, 0]:
        axis.set_yticks(range(len(maps)), maps)
    axes[0, 0].set_ylim(len(maps) - 0.5, -0.5)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=5)
    return figure
