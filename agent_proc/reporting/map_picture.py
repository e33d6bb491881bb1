"""Draws the picture of `legpush map`: a map from above, in metres."""

from math import ceil
from pathlib import Path
from textwrap import shorten
from typing import Final

import numpy as np

from agent_proc.figures import (
    Artist,
    Axes,
    FancyBboxPatch,
    Figure,
    Patch,
    PatchCollection,
    Polygon,
    Rectangle,
    own_style,
    save_figure,
    to_rgba,
)
from agent_proc.reporting.map_view import MapView
from agent_proc.reporting.style import BLUE, BOX, FLOOR, GOAL, INK, STYLE, WALL
from legpush.arrays import Flags
from legpush.geometry import Pose2
from legpush.scenarios.grid import merged_rectangles
from legpush.scene.footprints import box_footprint, foot_rectangle
from legpush.scene.occupancy import clearance_m
from legpush.scene.reference import reference_curve
from legpush.scene.scenario import Scenario

SOFTWARE: Final = "legpush map"
"""The software that a picture names as its author."""
HEAD_BYTES: Final = 1024
"""Number of bytes at the head of a PNG file in which its author is searched."""
UNKNOWN, KEPT_CLEAR, OUTSIDE = "#9aa1ac", "#f7e6d6", "#eef0f2"
LONGEST_IN: Final = (9.0, 7.5)
"""Width and height of the drawn map at most."""
LEAST_IN: Final = (7.0, 2.0)
"""Width and height of the drawn map at least."""
AROUND_IN: Final = (1.0, 1.5)
"""Additional width and height for labels, title and legend."""
RIM: Final = 0.03
"""Margin around the map, as a share of its longer side."""
NAME_LENGTH: Final = 40
DPI: Final = 140
MOST_PIXELS: Final = 800
"""Pixels along a side of the map: fewer than the picture has there, so that no cell is lost."""
LEAST_ARROW: Final = 0.035
"""Shortest arrow, as a share of the map's longer side, so that a heading is visible in a large room."""


def is_own_picture(path: Path) -> bool:
    """Whether a file was written by `save_map_picture`."""
    with path.open("rb") as file:
        return SOFTWARE.encode() in file.read(HEAD_BYTES)


def save_map_picture(view: MapView, path: Path) -> None:
    """Draw the map and write it, in the format of the ending of `path`."""
    scale = min(longest / side for longest, side in zip(LONGEST_IN, view.size_m, strict=True))
    width_in, height_in = (
        max(least, scale * side) + around for least, side, around in zip(LEAST_IN, view.size_m, AROUND_IN, strict=True)
    )
    with own_style(STYLE):
        figure = Figure(figsize=(width_in, height_in), layout="constrained")
        axes = figure.add_subplot()
        _draw_map(axes, view)
        if view.scenario is not None:
            _draw_scenario(axes, view.scenario)
        _draw_origins(axes, view)
        rim_m = RIM * max(view.size_m)
        axes.set(xlim=(-rim_m, view.size_m[0] + rim_m), ylim=(-rim_m, view.size_m[1] + rim_m))
        axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", facecolor=OUTSIDE)
        axes.set_title(_title(view))
        figure.legend(handles=_legend(axes, view), loc="outside lower center", ncols=3)
        save_figure(figure, path, dpi=DPI, software=SOFTWARE)


def _title(view: MapView) -> str:
    n_rows, n_columns = view.occupied.shape
    size = f"{view.size_m[0]:g} x {view.size_m[1]:g} m"
    return f"{shorten(view.name, NAME_LENGTH)}: {size}, {n_columns} x {n_rows} cells of {view.resolution_m:g} m"


def _draw_map(axes: Axes, view: MapView) -> None:
    """Draw occupied and unknown cells, and beneath them the zone that the trunk keeps clear."""
    width_m, height_m = view.size_m
    axes.add_patch(Rectangle((0.0, 0.0), width_m, height_m, fc=FLOOR, lw=0, zorder=1))
    if view.scenario is not None:
        _draw_kept_clear(axes, view, clearance_m(view.scenario))
    _draw_cells(axes, view.occupied, view.resolution_m, WALL, 3.0)
    if view.source is not None:
        _draw_cells(axes, view.source.unknown, view.source.cell_m, UNKNOWN, 3.1)
    axes.add_patch(Rectangle((0.0, 0.0), width_m, height_m, fill=False, ec=INK, lw=0.8, zorder=3.2))


def _draw_cells(axes: Axes, cells: Flags, cell_m: float, color: str, zorder: float) -> None:
    """Draw the set cells, (rows, columns), row 0 at y = 0; a pixel is drawn if any of its cells is set."""
    block = ceil(max(cells.shape) / MOST_PIXELS)
    n_rows, n_columns = (-(-n // block) for n in cells.shape)
    padded = np.zeros((n_rows * block, n_columns * block), dtype=np.bool_)
    padded[: cells.shape[0], : cells.shape[1]] = cells
    pixels = np.zeros((n_rows, n_columns, 4), dtype=np.uint8)
    pixels[..., :3] = np.round(255 * np.array(to_rgba(color)[:3]))
    pixels[..., 3] = 255 * padded.reshape(n_rows, block, n_columns, block).any(axis=(1, 3))
    extent = (0.0, n_columns * block * cell_m, 0.0, n_rows * block * cell_m)
    axes.imshow(pixels, origin="lower", extent=extent, interpolation="nearest", zorder=zorder)


def _draw_kept_clear(axes: Axes, view: MapView, reach_m: float) -> None:
    """Draw the zone nearer than `reach_m` to an occupied cell or to the border."""
    width_m, height_m = view.size_m
    inner = Rectangle((reach_m, reach_m), max(width_m - 2 * reach_m, 0.0), max(height_m - 2 * reach_m, 0.0))
    axes.add_patch(Rectangle((0.0, 0.0), width_m, height_m, fc=KEPT_CLEAR, lw=0, zorder=1.1))
    axes.add_patch(Rectangle(inner.get_xy(), inner.get_width(), inner.get_height(), fc=FLOOR, lw=0, zorder=1.2))
    style = f"round,pad={reach_m},rounding_size={reach_m}"
    around = [
        FancyBboxPatch((r.x_min_m, r.y_min_m), r.x_max_m - r.x_min_m, r.y_max_m - r.y_min_m, boxstyle=style)
        for r in merged_rectangles(view.occupied, view.resolution_m)
    ]
    zone = PatchCollection(around, fc=KEPT_CLEAR, lw=0, zorder=1.3)
    axes.add_collection(zone)
    zone.set_clip_path(Rectangle((0.0, 0.0), width_m, height_m, transform=axes.transData))


def _draw_scenario(axes: Axes, scenario: Scenario) -> None:
    """Draw the start of the robot, the box, its goal, and the reference between them if there is one."""
    start, box, goal = scenario.start.pose(), scenario.box.pose.pose(), scenario.goal.pose.pose()
    if scenario.reference is not None:
        curve = reference_curve(scenario.reference, box)
        axes.plot(*curve[:, :2].T, color=GOAL, lw=1.4, ls=(0, (4, 1)), label="reference", zorder=4)
    feet = foot_rectangle(scenario.robot, start)
    for footprint, color, label, opacity in (
        (feet, BLUE, "start of the robot", 0.45),
        (box_footprint(scenario.box, box), BOX, "box", 0.45),
        (box_footprint(scenario.box, goal), GOAL, "goal of the box", 0.0),
    ):
        face = (*to_rgba(color)[:3], opacity)
        axes.add_patch(Polygon(footprint.corners(), fc=face, ec=color, lw=1.4, label=label, zorder=5))
        arrow_m = max(footprint.length_m, LEAST_ARROW * max(scenario.room.size_m))
        _draw_heading(axes, footprint.pose, arrow_m, color)


def _draw_heading(axes: Axes, pose: Pose2, length_m: float, color: str) -> None:
    tip_x_m, tip_y_m = pose.apply([length_m, 0.0])
    arrow = {"arrowstyle": "-|>", "color": color, "lw": 1.2, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 8}
    axes.annotate("", xy=(tip_x_m, tip_y_m), xytext=(pose.x_m, pose.y_m), arrowprops=arrow, zorder=6)


def _draw_origins(axes: Axes, view: MapView) -> None:
    """Draw the origin of the room, and that of the map's own frame if it is another one inside the map."""
    axes.plot(0.0, 0.0, "o", color=INK, ms=6, mfc="white", mew=1.6, ls="", label="origin (0, 0)", zorder=7)
    axes.lines[-1].set_clip_on(False)
    x_m, y_m = (-origin for origin in view.origin_m)
    if (x_m, y_m) != (0.0, 0.0) and 0.0 <= x_m <= view.size_m[0] and 0.0 <= y_m <= view.size_m[1]:
        label = f"origin of the map's frame, ({x_m:g}, {y_m:g})"
        axes.plot(x_m, y_m, "P", color="white", mec=INK, ms=9, mew=1.2, ls="", label=label, zorder=7)


def _legend(axes: Axes, view: MapView) -> list[Artist]:
    """Entries for the colours, then for everything with a label."""
    handles: list[Artist] = [Patch(fc=WALL, label="occupied")]
    if view.source is not None and view.source.unknown.any():
        handles.append(Patch(fc=UNKNOWN, label="unknown, counts as occupied"))
    if view.scenario is not None:
        reach_m = clearance_m(view.scenario)
        handles.append(Patch(fc=KEPT_CLEAR, label=f"nearer than the trunk's centre may come ({reach_m:.2f} m)"))
    return handles + list(axes.get_legend_handles_labels()[0])
