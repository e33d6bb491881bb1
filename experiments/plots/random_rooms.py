"""Draws the mosaic of `python -m experiments.random_rooms`: every room with the tracks of robot and box."""

from math import ceil
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from experiments.evaluations import RESULTS
from legpush.scene.footprints import box_footprint, obstacle_footprint
from legpush.scene.scenario import Scenario

N_COLUMNS: Final = 12
GOOD, BAD = "#2b8a4b", "#c0392b"


def draw(rows: list[dict[str, Any]], scenarios: list[Scenario], tracks: list[dict[str, Any]]) -> None:
    """Draw all rooms; the frame is green if the mission succeeded, else red."""
    by_seed: dict[int, list[dict[str, Any]]] = {}
    for point in tracks:
        by_seed.setdefault(int(point["seed"]), []).append(point)
    n_rows = ceil(len(rows) / N_COLUMNS)
    figure = Figure(figsize=(1.25 * N_COLUMNS, 1.36 * n_rows), layout="constrained")
    cells = np.atleast_1d(figure.subplots(n_rows, N_COLUMNS, squeeze=False)).ravel()
    for axis in cells:
        axis.set_axis_off()
    for axis, row, scenario in zip(cells, rows, scenarios, strict=False):
        _draw_room(axis, row, scenario, by_seed.get(int(row["seed"]), []))
    figure.suptitle(
        "Random rooms: the box (brown) from dashed to green, the robot's way (blue); red frames: no success"
    )
    figure.savefig(RESULTS / "random_rooms.png", dpi=90)


def _draw_room(axis: Axes, row: dict[str, Any], scenario: Scenario, track: list[dict[str, Any]]) -> None:
    good = str(row["success"]) == "True"
    axis.set_axis_on()
    axis.set(xticks=[], yticks=[], aspect="equal", xlim=(0, scenario.room.size_m[0]), ylim=(0, scenario.room.size_m[1]))
    for spine in axis.spines.values():
        spine.set_color(GOOD if good else BAD)
        spine.set_linewidth(1.0 if good else 2.5)
    for obstacle in scenario.room.obstacles:
        axis.add_patch(Polygon(obstacle_footprint(obstacle).corners(), color="#3b3f45"))
    for pose, color, style in ((scenario.box.pose, "#8d6748", "--"), (scenario.goal.pose, GOOD, "-")):
        corners = box_footprint(scenario.box, pose.pose()).corners()
        axis.add_patch(Polygon(corners, fill=False, color=color, linestyle=style, linewidth=1.0))
    for body, color in (("trunk", "#3a6ea5"), ("box", "#8d6748")):
        points = np.array([[float(point[f"{body}_x_m"]), float(point[f"{body}_y_m"])] for point in track]).reshape(
            -1, 2
        )
        axis.plot(*points.T, color=color, linewidth=0.7 if body == "trunk" else 1.3)
    label = "" if good else f" {row['reason']}"
    axis.set_title(f"{row['seed']}{label}", fontsize=5, pad=1)
