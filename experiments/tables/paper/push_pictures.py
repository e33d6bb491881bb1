"""Curves of pushes as the paper draws them: by degree (Fig. 6), as a family (Figs. 7, 8), from the side (Fig. 9)."""

from typing import Final

import numpy as np

from agent_proc.figures import Axes, Figure, legend_below
from experiments.rows import Row, read_rows
from experiments.tables.paper.push_curves import USUAL_DEPTH_M, curve_name
from legpush.arrays import Floats
from legpush.scene.robot import RobotSpec
from sim_proc.control.swing import LOCUS_RANGE_RAD, Locus, bezier, control_points

LOOKS: Final = {
    "chord": "tab:gray",
    "all 0.25": "tab:blue",
    "all 0.5": "tab:orange",
    "all 0.75": "tab:green",
    "even": "tab:red",
}
FLOOR_M: Final = RobotSpec().legs.foot_radius_m
"""Height of the centre of a foot on the floor."""
LOCI: Final[dict[Locus, str]] = {"swing": "θ in [-π/2, π/2]", "published": "θ in [0, π], as printed"}
N_PANELS: Final = 6
TRAINED_KG: Final = 0.1


def pictures() -> dict[str, Figure]:
    """Draw all three."""
    return {"push_degrees.png": _degrees(), "push_loci.png": _loci(), "push_close_up.png": _close_up()}


def _degrees() -> Figure:
    """Draw the planned curves of each degree with their control points, and the measured ways of the foot."""
    rows = read_rows("push_degrees").where(depth_m=USUAL_DEPTH_M, leg="FL")
    first = min(row["seed"] for row in rows)
    figure = Figure(figsize=(14.0, 3.9), layout="constrained", dpi=110)
    degrees = sorted({row["degree"] for row in rows})
    axes = figure.subplots(1, len(degrees), sharey=True)
    for axis, degree in zip(axes, degrees, strict=True):
        for row in rows:
            if (row["degree"], row["seed"]) == (degree, first):
                _draw_degree(axis, row)
        axis.set(title=f"degree {degree}", xlabel="along the push [m]", aspect="equal")
        axis.axhline(FLOOR_M, color="black", linewidth=0.7)
        legend_below(axis, n_columns=2)
        axis.grid(alpha=0.25)
    axes[0].set_ylabel("height of the foot's centre [m]")
    figure.suptitle(
        "Planned curves, with control points (circles, dashed); measured ways of the foot (dots), 5 cm deep"
    )
    return figure


def _draw_degree(axis: Axes, row: Row) -> None:
    name, measured = curve_name(row), way_of(row)
    start, end = np.array([*measured[0], 0.0])[[0, 2, 1]], np.array([*measured[-1], 0.0])[[0, 2, 1]]
    points = control_points(start, end, row["weights"], row["locus"], FLOOR_M)
    curve = bezier(points, np.linspace(0.0, 1.0, 101))
    axis.plot(curve[:, 0], curve[:, 2], color=LOOKS[name], label="chord" if name == "chord" else f"w {name}")
    axis.plot(points[:, 0], points[:, 2], "o--", color=LOOKS[name], markerfacecolor="none", linewidth=0.7, markersize=5)
    axis.plot(*measured.T, ".", color=LOOKS[name], markersize=3)


def way_of(row: Row) -> Floats:
    """Return the measured way of a foot along the push and upward, (n, 2)."""
    return np.column_stack([row["foot_x_m"], row["foot_z_m"]])


def _loci() -> Figure:
    """Draw the circle of Eq. 15 and the measured ways of the foot for a grid of w1 and w2."""
    rows = read_rows("push_loci").where(leg="FL")
    first = min(row["seed"] for row in rows)
    heights = sorted({row["box_height_m"] for row in rows}, reverse=True)
    figure = Figure(figsize=(11.0, 8.0), layout="constrained", dpi=110)
    for panels, height_m in zip(figure.subplots(len(heights), len(LOCI), sharey="row"), heights, strict=True):
        for axis, (locus, title) in zip(panels, LOCI.items(), strict=True):
            family = [
                row for row in rows if (row["box_height_m"], row["locus"], row["seed"]) == (height_m, locus, first)
            ]
            _draw_family(axis, locus, family)
            axis.set(title=f"{title}; box {height_m:g} m high", xlabel="along the push [m]", aspect="equal")
        panels[0].set_ylabel("height of the foot's centre [m]")
    figure.suptitle("Measured ways of the foot for 25 pairs of w1, w2 (colour: mean of both); dotted: the half circle")
    return figure


def _draw_family(axis: Axes, locus: Locus, family: list[Row]) -> None:
    start_m, end_m = way_of(family[0])[0], np.mean([way_of(row)[-1] for row in family], axis=0)
    theta = np.linspace(*LOCUS_RANGE_RAD[locus], 101)
    middle_m, half_m = (start_m + end_m) / 2, (end_m - start_m) / 2
    normal_m = np.array([-half_m[1], half_m[0]])
    circle = middle_m + np.sin(theta)[:, None] * half_m + np.cos(theta)[:, None] * normal_m
    axis.plot(*circle.T, ":", color="black", linewidth=1.2)
    for row in sorted(family, key=lambda row: float(np.mean(row["weights"]))):
        share = float(np.mean(row["weights"]))
        axis.plot(*way_of(row).T, color=(share, 0.35, 1.0 - share), linewidth=0.9, alpha=0.8)
    axis.axhline(FLOOR_M, color="black", linewidth=0.7)
    axis.axvline(end_m[0] - USUAL_DEPTH_M, color="saddlebrown", linewidth=1.0, label="foot at the face")
    legend_below(axis, n_columns=3)
    axis.grid(alpha=0.25)


def _close_up() -> Figure:
    """Draw six moments of one push from the side: leg, way of the foot, box, and force on the foot."""
    row = read_rows("close_up").where(mass_kg=TRAINED_KG)[0]
    ticks = np.linspace(0, len(row["foot_x_m"]) - 1, N_PANELS).round().astype(int).tolist()
    figure = Figure(figsize=(11.0, 6.6), layout="constrained", dpi=110)
    axes = figure.subplots(2, N_PANELS // 2, sharex=True, sharey=True)
    for number, (axis, tick) in enumerate(zip(axes.flat, ticks, strict=True), start=1):
        _draw_moment(axis, row, tick)
        force = f"{row['force_n'][tick]:.1f} N on the foot"
        axis.set(title=f"({number}) after {0.02 * tick:.2f} s, {force}", aspect="equal")
    for axis in axes[-1]:
        axis.set_xlabel("ahead of the face before the push [m]")
    for axis in axes[:, 0]:
        axis.set_ylabel("height [m]")
    figure.suptitle("One push with the left front foot, 5 cm deep, w1 = w2 = 0.5, 0.1 kg")
    return figure


def _draw_moment(axis: Axes, row: Row, tick: int) -> None:
    length_m, height_m = row["box_length_m"], row["box_height_m"]
    left_m = row["box_x_m"][tick] - length_m / 2
    right_m = left_m + length_m
    corners = np.array([[left_m, 0], [right_m, 0], [right_m, height_m], [left_m, height_m], [left_m, 0]])
    axis.fill(*corners.T, color="burlywood", alpha=0.6)
    axis.plot(*corners.T, color="saddlebrown", linewidth=1.0)
    axis.axvline(0.0, color="saddlebrown", linestyle=":", linewidth=0.8)
    leg = [(row[f"{name}_x_m"][tick], row[f"{name}_z_m"][tick]) for name in ("hip", "knee", "foot")]
    axis.plot(*np.array(leg).T, "o-", color="dimgray", linewidth=5, markersize=7, solid_capstyle="round")
    axis.plot(row["foot_x_m"][: tick + 1], row["foot_z_m"][: tick + 1], color="tab:green", linewidth=2)
    axis.axhline(0.0, color="black", linewidth=1.0)
    axis.set(xlim=(-0.55, 0.5), ylim=(-0.02, 0.6))
