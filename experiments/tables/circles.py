"""Circles by one action, repeated, beside the published series (Figs. 18 to 20)."""

from typing import Any, Final

import numpy as np

from agent_proc.figures import Axes, Figure, legend_below
from experiments.cells.circle import sine
from experiments.rows import Row, Rows, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, published

SHOWN: Final = (0.03, 0.05, 0.08)
FRICTION: Final = 0.5
USUAL_DEPTH_M: Final = 0.05
PUBLISHED_FITS: Final = {
    "left": (1.2570082, 4.24756e-4, -1.5136131, 9.8818031, 4515.874, 0.838),
    "right": (1.0896589, 4.67027e-4, -2.2201639, 10.3937474, 5933.365, 0.908),
}
"""Amplitude [m], omega [rad/s], phi [rad], offset [m], begin of the fit [s], and R2."""
N_DIGITS: Final = 6
INPUTS: Final = ("direction", "depth_m", "friction", "seed")


def _read() -> dict[str, Rows]:
    return {name: read_rows(name) for name in ("circles", "circles_usual")}


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = _read()
    rows = [row for study in studies.values() for row in study.rows]
    usual = [row for row in rows if (row["depth_m"], row["friction"]) == (USUAL_DEPTH_M, FRICTION)]
    names = [name for name in rows[0] if name in INPUTS or _is_plain(rows[0][name])]
    table = [{name: _rounded(row[name]) for name in names} for row in rows]
    numbers = {
        "n": len(rows),
        "least_r2": min(row["r2"] for row in rows),
        "largest_closing_m": max(row["closing_m"] for row in rows),
        "largest_tilt_deg": max(max(row["max_abs_roll_deg"], row["max_abs_pitch_deg"]) for row in rows),
        "usual": {
            "least_r2": min(row["r2"] for row in usual),
            "largest_closing_m": max(row["closing_m"] for row in usual),
            **{
                direction: float(np.mean([row["radius_m"] for row in usual if row["direction"] == direction]))
                for direction in PUBLISHED_FITS
            },
        },
    }
    return {"circles.csv": as_csv(table), "circles.json": as_json(made_of(**studies), numbers)}


def _is_plain(value: Any) -> bool:
    return isinstance(value, int | float) or value in ("x", "y")


def _rounded(value: Any) -> Any:
    return round(value, N_DIGITS) if isinstance(value, float) else value


def pictures() -> dict[str, Figure]:
    """Draw the tracks from above, a coordinate over time with its sine, and the published coordinate with its sine."""
    rows = read_rows("circles").rows
    figure = Figure(figsize=(13.0, 7.4), layout="constrained", dpi=110)
    for axes, direction in zip(figure.subplots(2, 3), ("left", "right"), strict=True):
        _draw_tracks(axes[0], direction, rows)
        _draw_ours(axes[1], direction, rows)
        _draw_published(axes[2], direction)
    figure.suptitle("Fixed actions push the box along circles")
    return {"circles.png": figure}


def _of(rows: list[Row], direction: str, depth_m: float) -> Row:
    """Return the row at a depth and the usual friction."""
    wanted = (direction, depth_m, FRICTION)
    return next(row for row in rows if (row["direction"], row["depth_m"], row["friction"]) == wanted)


def _draw_tracks(axis: Axes, direction: str, rows: list[Row]) -> None:
    for depth_m in SHOWN:
        one = _of(rows, direction, depth_m)
        label = f"depth {100 * depth_m:g} cm: radius {one['radius_m']:.3f} m"
        axis.plot(one["cycle_x_m"], one["cycle_y_m"], ".-", markersize=3, linewidth=0.7, label=label)
    axis.set(xlabel="x [m]", ylabel="y [m]", title=f"{direction}: the box after each push, two turns", aspect="equal")
    legend_below(axis, n_columns=1)
    axis.grid(alpha=0.25)


def _draw_ours(axis: Axes, direction: str, rows: list[Row]) -> None:
    one = _of(rows, direction, USUAL_DEPTH_M)
    time_s = np.array(one["cycle_time_s"])
    axis.step(time_s, one[f"cycle_{one['axis']}_m"], where="post", label="box")
    fit = (one["amplitude_m"], one["omega_rad_s"], one["phi_rad"], one["offset_m"])
    axis.plot(time_s, sine(time_s, *fit), "--", label=f"A sin(ωt + φ) + c, R² {one['r2']:.4f}")
    axis.set(xlabel="time [s]", ylabel=f"{one['axis']} [m]", title=f"{direction}: depth {100 * USUAL_DEPTH_M:g} cm")
    axis.margins(y=0.25)
    legend_below(axis, n_columns=2)
    axis.grid(alpha=0.25)


def _draw_published(axis: Axes, direction: str) -> None:
    data = np.array([list(row.values()) for row in published(f"circle_{direction}.csv")])
    *fit, begin_s, r2 = PUBLISHED_FITS[direction]
    fitted_s = data[data[:, 0] >= begin_s, 0]
    axis.plot(data[:, 0], data[:, 1], label="box")
    axis.plot(fitted_s, sine(fitted_s, *fit), "--", label=f"A sin(ωt + φ) + c, R² {r2:.3f}")
    axis.set(xlabel="time [s]", ylabel="coordinate [m]", title=f"{direction}: published (Fig. 20)")
    axis.margins(y=0.25)
    legend_below(axis, n_columns=2)
    axis.grid(alpha=0.25)
