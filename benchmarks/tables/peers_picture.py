"""Draws the comparison with other projects: time over length, a panel per map, runs faint and medians strong."""

from math import ceil
from typing import Final

import numpy as np

from agent_proc.figures import Figure
from experiments.rows import Row

N_COLUMNS: Final = 3
COLORS: Final = {
    "legpush rrt_connect": "#2b6f9e",
    "legpush rrt": "#7db8dc",
    "legpush rrt_star": "#123a57",
    "legpush rrt_connect, not smoothed": "#2a9d8f",
    "python_motion_planning RRT, Numba": "#e08a8a",
    "python_motion_planning RRT*, Numba": "#9c2b2b",
    "python_motion_planning RRT, pure Python": "#e3b679",
    "python_motion_planning RRT*, pure Python": "#a8640f",
    "pathplanning rrt, C": "#999999",
    "pathplanning rrt_connect, C": "#222222",
}


def draw(runs: list[Row]) -> Figure:
    """Draw the runs that found a path with the required clearance."""
    good = [row for row in runs if row["keeps_clearance"]]
    maps = list(dict.fromkeys(row["map"] for row in runs))
    figure = Figure(figsize=(14.0, 4.4 * ceil(len(maps) / N_COLUMNS) + 1.2), layout="constrained", dpi=80)
    axes = figure.subplots(ceil(len(maps) / N_COLUMNS), N_COLUMNS, squeeze=False).ravel()
    for axis, name in zip(axes, maps, strict=False):
        for label, color in COLORS.items():
            here = [row for row in good if (row["map"], row["planner"]) == (name, label)]
            if not here:
                continue
            length_m, seconds = (np.array([float(row[key]) for row in here]) for key in ("length_m", "seconds"))
            axis.plot(length_m, seconds, ".", color=color, alpha=0.3, markersize=5)
            mark = "o" if label.startswith("legpush") else "s"
            axis.plot(np.median(length_m), np.median(seconds), mark, color=color, markersize=8, label=label)
        axis.set(title=name, xlabel="length [m]", ylabel="time to the path [s]", yscale="log")
        axis.grid(alpha=0.25)
    for axis in axes[len(maps) :]:
        axis.set_axis_off()
    handles = {label: handle for axis in axes for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=3)
    return figure
