"""Draws the picture of `python -m experiments.circles` from its tables in `results/`."""

from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.evaluations import RESULTS, read_table
from legpush.arrays import Floats

PUBLISHED: Final = Path(__file__).parents[1] / "published"
SHOWN: Final = (0.03, 0.05, 0.08)
FRICTION: Final = 0.5
USUAL_DEPTH_M: Final = 0.05
PUBLISHED_FITS: Final = {
    "left": (1.2570082, 4.24756e-4, -1.5136131, 9.8818031, 4515.874, 0.838),
    "right": (1.0896589, 4.67027e-4, -2.2201639, 10.3937474, 5933.365, 0.908),
}
"""Amplitude [m], omega [rad/s], phi [rad], offset [m], begin of the fit [s], and R2."""


def draw() -> None:
    """Draw the tracks from above, a coordinate over time with its sine, and the published coordinate with its sine."""
    rows, series = (
        [{key: _number(value) for key, value in row.items()} for row in read_table(RESULTS / name)]
        for name in ("circles.csv", "circles_series.csv.gz")
    )
    figure = Figure(figsize=(13.0, 7.4), layout="constrained")
    for axes, direction in zip(figure.subplots(2, 3), ("left", "right"), strict=True):
        _draw_tracks(axes[0], direction, rows, series)
        _draw_ours(axes[1], direction, rows, series)
        _draw_published(axes[2], direction)
    figure.suptitle("Fixed actions push the box along circles")
    figure.savefig(RESULTS / "circles.png", dpi=110)


def _of(rows: list[dict[str, Any]], direction: str, depth_m: float) -> list[dict[str, Any]]:
    """Return the rows of the first start at a depth and the usual friction."""
    found = [r for r in rows if (r["direction"], r["depth_m"], r["friction"]) == (direction, depth_m, FRICTION)]
    return [row for row in found if row["seed"] == found[0]["seed"]]


def _draw_tracks(axis: Axes, direction: str, rows: list[dict[str, Any]], series: list[dict[str, Any]]) -> None:
    for depth_m in SHOWN:
        (one,) = _of(rows, direction, depth_m)
        here = _of(series, direction, depth_m)
        label = f"depth {100 * depth_m:g} cm: radius {one['radius_m']:.3f} m"
        axis.plot([r["x_m"] for r in here], [r["y_m"] for r in here], ".-", markersize=3, linewidth=0.7, label=label)
    axis.set(xlabel="x [m]", ylabel="y [m]", title=f"{direction}: the box after each push, two turns", aspect="equal")
    axis.legend(fontsize=7, loc="center")
    axis.grid(alpha=0.25)


def _draw_ours(axis: Axes, direction: str, rows: list[dict[str, Any]], series: list[dict[str, Any]]) -> None:
    (one,) = _of(rows, direction, USUAL_DEPTH_M)
    here = _of(series, direction, USUAL_DEPTH_M)
    time_s = np.array([row["time_s"] for row in here])
    axis.step(time_s, [row[one["axis"] + "_m"] for row in here], where="post", label="box")
    fit = (one["amplitude_m"], one["omega_rad_s"], one["phi_rad"], one["offset_m"])
    axis.plot(time_s, _sine(time_s, *fit), "--", label=f"A sin(ωt + φ) + c, R² {one['r2']:.4f}")
    axis.set(xlabel="time [s]", ylabel=f"{one['axis']} [m]", title=f"{direction}: depth {100 * USUAL_DEPTH_M:g} cm")
    axis.margins(y=0.25)
    axis.legend(fontsize=8, loc="upper right")
    axis.grid(alpha=0.25)


def _draw_published(axis: Axes, direction: str) -> None:
    data = np.array(
        [[float(value) for value in row.values()] for row in read_table(PUBLISHED / f"circle_{direction}.csv")]
    )
    *fit, begin_s, r2 = PUBLISHED_FITS[direction]
    fitted_s = data[data[:, 0] >= begin_s, 0]
    axis.plot(data[:, 0], data[:, 1], label="box")
    axis.plot(fitted_s, _sine(fitted_s, *fit), "--", label=f"A sin(ωt + φ) + c, R² {r2:.3f}")
    axis.set(xlabel="time [s]", ylabel="coordinate [m]", title=f"{direction}: published (Fig. 20)")
    axis.margins(y=0.25)
    axis.legend(fontsize=8, loc="upper right")
    axis.grid(alpha=0.25)


def _sine(time_s: Floats, amplitude_m: float, omega_rad_s: float, phi_rad: float, offset_m: float) -> Floats:
    value: Floats = amplitude_m * np.sin(omega_rad_s * time_s + phi_rad) + offset_m
    return value


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
