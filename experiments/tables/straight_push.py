"""Corners of the box, angles of the trunk and errors in straight pushes of 1 m (Fig. 17)."""

from typing import Final

import numpy as np

from agent_proc.figures import Axes, Figure, legend_below
from experiments.cells.straight_push import EVERY_TICKS
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_json, made_of
from legpush.arrays import Floats
from legpush.geometry import Pose2, rectangle_corners
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import CONTROL_PERIOD_S

CORNERS: Final = ("front left", "rear left", "rear right", "front right")


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows("straight_push")
    numbers = {
        "n": len(study.rows),
        "mean_error_m": float(np.mean([row["error_m"][-1] for row in study.rows])),
        "mean_error_deg": float(np.mean([row["error_deg"][-1] for row in study.rows])),
    }
    return {"straight_push.json": as_json(made_of(straight_push=study), numbers)}


def pictures() -> dict[str, Figure]:
    """Draw the tracks of the corners from above, the angles of the trunk, and both errors."""
    rows = read_rows("straight_push").rows
    figure = Figure(figsize=(11.0, 7.0), layout="constrained", dpi=110)
    above, tilt, position, angle = figure.subplots(2, 2).flat
    _draw_above(above, rows)
    for row in rows:
        time_s = EVERY_TICKS * CONTROL_PERIOD_S * np.arange(len(row["roll_deg"]))
        for column, color in (("roll_deg", "tab:blue"), ("pitch_deg", "tab:orange")):
            tilt.plot(time_s, row[column], color=color, linewidth=0.5, alpha=0.6)
        position.plot(100 * np.array(row["error_m"]), color="tab:green", alpha=0.7)
        angle.plot(row["error_deg"], color="tab:purple", alpha=0.7)
    tilt.set(xlabel="time [s]", ylabel="roll (blue), pitch (orange) [deg]", title="trunk; published: within ±5 deg")
    position.set(
        xlabel="push cycle", ylabel="position error [cm]", yscale="log", title="box position; published: 18 cm"
    )
    angle.set(xlabel="push cycle", ylabel="angle error [deg]", title="box angle; published: 0.59 deg")
    for axis in (tilt, position, angle):
        axis.grid(which="both", alpha=0.25)
    figure.suptitle(f"Straight push of 1 m at 0.1 kg, policy {rows[0]['policy']}, {len(rows)} unseen starts")
    return {"straight_push.png": figure}


def _draw_above(axis: Axes, rows: list[Row]) -> None:
    scenario = load_scenario("push")
    outline = rectangle_corners(*scenario.box.size_m[:2])
    tracks = [corners_of(row, outline) for row in rows]
    for index, name in enumerate(CORNERS):
        for number, track in enumerate(tracks):
            axis.plot(*track[:, index].T, color=f"C{index}", linewidth=0.8, label=name if number == 0 else None)
    for place in (0, -1):
        for track in tracks:
            axis.plot(*np.vstack([track[place], track[place][:1]]).T, color="gray", linewidth=0.5)
    goal = scenario.goal.pose.pose().apply(outline)
    axis.plot(*np.vstack([goal, goal[:1]]).T, color="black", linestyle="--", label="goal")
    axis.set(xlabel="x [m]", ylabel="y [m]", title="tracks of the corners", aspect="equal")
    legend_below(axis, n_columns=5)


def corners_of(row: Row, outline: Floats) -> Floats:
    """Return the corners of the box by time, (n, 4, 2)."""
    poses = zip(row["box_x_m"], row["box_y_m"], np.radians(row["box_yaw_deg"]).tolist(), strict=True)
    return np.array([Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad).apply(outline) for x_m, y_m, yaw_rad in poses])
