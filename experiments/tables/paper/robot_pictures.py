"""The robot while it pushes: its joints and frames (Fig. 1), its support (Fig. 2), and the forces on its feet (Fig. 3).

All three panels show the tick of one push in which the box presses the most.
"""

from typing import Final

import numpy as np

from agent_proc.figures import Axes, Figure
from experiments.rows import Row, read_rows
from legpush.arrays import Floats
from legpush.scene.conventions import LEGS, Leg

HEAVY_KG: Final = 5.0
"""A box whose force can be seen beside the weight of the robot."""
PUSHING: Final = LEGS.index("FL")
M_PER_N: Final = 0.001
"""Length of an arrow for each newton."""
LABELS: Final[dict[Leg, tuple[int, int]]] = {"FL": (-8, -14), "FR": (4, -14), "RL": (-48, 14), "RR": (6, 4)}
"""Offsets of the names of the forces."""
FRAME_M: Final = 0.15
"""Length of the axes of a frame."""
AROUND_DEG: Final = 30.0
ABOVE_DEG: Final = 25.0
"""From where the robot is seen: turned about the vertical, and from above."""
AXES: Final = (("x", "tab:red"), ("y", "tab:green"), ("z", "tab:blue"))


def pictures() -> dict[str, Figure]:
    """Draw the three panels."""
    row = read_rows("close_up").where(mass_kg=HEAVY_KG)[0]
    figure = Figure(figsize=(14.5, 4.4), layout="constrained", dpi=110)
    _draw_frames(figure.add_subplot(1, 3, 1), row)
    _draw_support(figure.add_subplot(1, 3, 2), row)
    _draw_forces(figure.add_subplot(1, 3, 3), row)
    figure.suptitle(f"The left front foot pushes a box of {HEAVY_KG:g} kg: the tick in which the box presses the most")
    return {"push_robot.png": figure}


def points_of(row: Row, name: str) -> Floats:
    """Return places or forces of a row, (n, 3)."""
    return np.array(row[name]).reshape(-1, 3)


def _draw_frames(axis: Axes, row: Row) -> None:
    """Draw links and joints obliquely, with the frames of the trunk and of the world."""
    trunk = points_of(row, "press_trunk_m")
    axis.plot(*seen(np.vstack([trunk, trunk[:1]])).T, color="goldenrod", linewidth=2)
    joints = [points_of(row, f"press_{name}_m") for name in ("hip_x", "hip_y", "knee", "foot")]
    for leg, name in enumerate(LEGS):
        chain = seen(np.array([points[leg] for points in joints]))
        axis.plot(*chain.T, "o-", color="dimgray", markersize=4, linewidth=2)
        _write(axis, name, chain[-1], (2, -11), "dimgray")
    for origin, title in ((trunk.mean(axis=0), "b"), (np.zeros(3), "w")):
        for index, (letter, color) in enumerate(AXES):
            line = seen(np.array([origin, origin + FRAME_M * np.eye(3)[index]]))
            axis.plot(*line.T, color=color, linewidth=2)
            _write(axis, f"{letter} {title}", line[1], (3, 2), color)
    axis.set(title="links and joints; frames of trunk (b) and world (w)", aspect="equal")
    axis.margins(0.12)
    axis.set_axis_off()


def seen(points: Floats) -> Floats:
    """Return points in space, (n, 3), as seen obliquely from the right and above, (n, 2)."""
    around, above = np.radians(AROUND_DEG), np.radians(ABOVE_DEG)
    right = np.array([np.cos(around), np.sin(around), 0.0])
    up = np.array([-np.sin(around) * np.sin(above), np.cos(around) * np.sin(above), np.cos(above)])
    return np.column_stack([points @ right, points @ up])


def _write(axis: Axes, text: str, place: Floats, offset: tuple[int, int], color: str) -> None:
    x, y = place.tolist()
    axis.annotate(text, (x, y), xytext=offset, textcoords="offset points", fontsize=8, color=color)


def _draw_support(axis: Axes, row: Row) -> None:
    """Draw feet, support triangle, its centroid (Eq. 8) and the CoM from above."""
    feet, com = points_of(row, "press_foot_m"), points_of(row, "press_com_m")[0]
    standing = np.array([feet[leg] for leg in range(len(LEGS)) if leg != PUSHING])
    axis.fill(*standing[:, :2].T, color="tab:blue", alpha=0.15, label="support polygon")
    trunk = points_of(row, "press_trunk_m")
    axis.plot(*np.vstack([trunk, trunk[:1]])[:, :2].T, color="goldenrod", linewidth=1)
    for foot, name in zip(feet, LEGS, strict=True):
        axis.plot(*foot[:2], "o", color="dimgray")
        _write(axis, name, foot[:2], (4, 4), "dimgray")
    axis.plot(*standing[:, :2].mean(axis=0), "D", color="tab:blue", label="centroid of Eq. 8")
    axis.plot(*com[:2], "*", color="tab:red", markersize=11, label="CoM")
    axis.axvline(0.0, color="saddlebrown", linestyle=":", label="face before the push")
    axis.set(title="support from above", xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axis.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=4)
    axis.margins(0.15)
    axis.grid(alpha=0.25)


def _draw_forces(axis: Axes, row: Row) -> None:
    """Draw the forces on the feet and the weight from the side, and say what their moments about the CoM add up to."""
    feet, forces = points_of(row, "press_foot_m"), points_of(row, "press_forces_n")
    com, trunk = points_of(row, "press_com_m")[0], points_of(row, "press_trunk_m")
    hips, knees = points_of(row, "press_hip_y_m"), points_of(row, "press_knee_m")
    for leg in range(len(LEGS)):
        axis.plot(*np.array([hips[leg], knees[leg], feet[leg]])[:, [0, 2]].T, "-", color="lightgray", linewidth=3)
    axis.plot(*trunk[:, [0, 2]].T, color="goldenrod", linewidth=2)
    for leg, (foot, force) in enumerate(zip(feet, forces, strict=True)):
        color = "tab:red" if leg == PUSHING else "tab:blue"
        _draw_arrow(axis, foot, foot + M_PER_N * force, color)
        _write(axis, f"{LEGS[leg]} {np.linalg.norm(force):.0f} N", foot[[0, 2]], LABELS[LEGS[leg]], color)
    weight_n = float(forces[:, 2].sum())
    _draw_arrow(axis, com, com - [0.0, 0.0, M_PER_N * weight_n], "black")
    axis.plot(*com[[0, 2]], "*", color="black", markersize=9)
    x_n_m, y_n_m, _ = row["press_moment_n_m"]
    axis.axvline(0.0, color="saddlebrown", linestyle=":")
    axis.axhline(0.0, color="black", linewidth=0.7)
    axis.set(title=f"forces; Eq. 9 adds up to {x_n_m:.1f} (x) and {y_n_m:.1f} N m (y)", xlabel="x [m]", ylabel="z [m]")
    axis.set(aspect="equal", xlim=(-1.0, 0.25), ylim=(-0.08, 0.65))


def _draw_arrow(axis: Axes, begin: Floats, end: Floats, color: str) -> None:
    arrow = {"arrowstyle": "-|>", "color": color, "linewidth": 1.8}
    tail, head = begin[[0, 2]].tolist(), end[[0, 2]].tolist()
    axis.annotate("", xy=(head[0], head[1]), xytext=(tail[0], tail[1]), arrowprops=arrow)
