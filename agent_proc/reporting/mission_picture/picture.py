"""Draws `mission.png`, the whole mission in one figure, from its journal alone.

At the left is the whole room, and below it the part that the mission used, if that is small. At the right are the
pushes and charts over time; a mission that did not walk or push has none of them.
"""

from collections.abc import Callable
from math import ceil
from pathlib import Path
from textwrap import wrap
from typing import Final

import numpy as np

from agent_proc.endings import MissionResult
from agent_proc.figures import Axes, ConstrainedLayoutEngine, Figure, own_style, save_figure
from agent_proc.reporting.mission_picture.charts import draw_box_error, draw_margins, draw_tilt, draw_torques
from agent_proc.reporting.mission_picture.parts import box_at, extent, pushed_faces, thin, widen
from agent_proc.reporting.mission_picture.room import draw_box, draw_feet, draw_mission, draw_robot, draw_room
from agent_proc.reporting.mission_record import MissionRecord
from agent_proc.reporting.style import INK, STYLE
from legpush.messages.poses import planar_pose
from legpush.scene.faces import pushed_pose
from legpush.scene.footprints import box_footprint

DPI: Final = 160
CHARACTERS_PER_IN: Final = 9.0
"""Characters of the headline that fit."""
MOST_COLUMNS: Final = 7
"""Of the legend."""
WIDTH_IN, HEIGHT_IN, ROOM_WIDTH_IN, AROUND_ROOM_IN = 13.6, 8.6, 8.0, 1.8
"""Of the figure, of one with the room alone, and what that needs for its labels."""
ZOOM_ASPECT: Final = 2.45
BEHIND_M: Final = np.array([0.6, 0.2])
BESIDE_M: Final = np.array([0.1, 0.2])
SMALL_SHARE: Final = 0.4
"""A part of the room that has less than this share of its area is drawn once more, larger."""
Panel = tuple[float, Callable[[Axes], None]]
"""Share of the height, and what draws it."""


def save_picture(record: MissionRecord, result: MissionResult, path: Path) -> None:
    """Draw the mission and write it, in the format of the ending of `path`: PNG, SVG or PDF."""
    with own_style(STYLE):
        panels = _panels(record)
        size_in = (WIDTH_IN, HEIGHT_IN) if panels else _size_of_room_in(record)
        figure = Figure(figsize=size_in, layout=ConstrainedLayoutEngine(w_pad=0.1, h_pad=0.06))
        columns = figure.add_gridspec(1, 2 if panels else 1, width_ratios=[1.42, 1.0] if panels else None)
        room = _draw_rooms(figure, columns[0, 0], record, result)
        if panels:
            _draw_panels(figure, columns[0, 1], panels)
        handles, labels = room.get_legend_handles_labels()
        most = MOST_COLUMNS if panels else MOST_COLUMNS // 2
        n_columns = ceil(len(labels) / ceil(len(labels) / most))
        figure.legend(handles, labels, loc="outside lower center", ncols=n_columns)
        headline = "\n".join(wrap(_headline(record, result), round(CHARACTERS_PER_IN * size_in[0])))
        figure.suptitle(headline, x=0.012, ha="left", fontsize=11.5, fontweight="bold", color=INK)
        save_figure(figure, path, dpi=DPI)


def _headline(record: MissionRecord, result: MissionResult) -> str:
    outcome = "success" if result.success else result.reason.replace("_", " ")
    return f"{record.scenario.name}, seed {record.seed}: {outcome} · {result.detail}"


def _size_of_room_in(record: MissionRecord) -> tuple[float, float]:
    """Size of a figure of the room alone."""
    width_m, height_m = record.scenario.room.size_m
    return ROOM_WIDTH_IN, min(HEIGHT_IN, ROOM_WIDTH_IN * height_m / width_m + AROUND_ROOM_IN)


def _draw_rooms(figure: Figure, place: object, record: MissionRecord, result: MissionResult) -> Axes:
    """Draw the whole room, and the part that the mission used if that is small; return the axes of the former."""
    width_m, height_m = record.scenario.room.size_m
    low, high = extent(record)
    is_small = float(np.prod(high - low)) < SMALL_SHARE * width_m * height_m
    rows = place.subgridspec(2 if is_small else 1, 1)  # type: ignore[attr-defined]
    whole: Axes = figure.add_subplot(rows[0, 0])
    draw_mission(whole, record, result)
    whole.set(xlim=(0.0, width_m), ylim=(0.0, height_m))
    whole.set_title("The whole room")
    whole.set_anchor("N")
    if is_small:
        part = figure.add_subplot(rows[1, 0])
        draw_mission(part, record, result)
        part.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        part.set_title("The part that the mission used")
        part.set_anchor("N")
        whole.indicate_inset((*low, *(high - low)), edgecolor=INK)
    return whole


def _panels(record: MissionRecord) -> list[Panel]:
    """What is drawn at the right: nothing about what did not happen."""
    panels: list[Panel] = []
    if record.pushing():
        panels.append((2.4, lambda axes: _draw_pushes(axes, record)))
    if len(record.ticks().time_s):
        panels += [
            (1.0, lambda axes: draw_tilt(axes, record)),
            (1.1, lambda axes: draw_margins(axes, record)),
        ]
    if np.isfinite(record.ticks().torques_n_m).any():
        panels.append((1.0, lambda axes: draw_torques(axes, record)))
    if record.pushing():
        panels.append((1.15, lambda axes: draw_box_error(axes, record)))
    return panels


def _draw_panels(figure: Figure, place: object, panels: list[Panel]) -> None:
    rows = place.subgridspec(len(panels), 1, height_ratios=[share for share, _ in panels])  # type: ignore[attr-defined]
    for index, (_, draw) in enumerate(panels):
        draw(figure.add_subplot(rows[index, 0]))


def _draw_pushes(axes: Axes, record: MissionRecord) -> None:
    """Draw the surroundings of the box, turned so that the face that was pushed most is pushed to the right."""
    scenario, faces = record.scenario, pushed_faces(record)
    seen = pushed_pose(scenario.goal.pose.pose(), faces[0]).inverse()
    draw_room(axes, record, seen)
    draw_feet(axes, record, seen, 0.7)
    axes.plot(*seen.apply(thin(record.ticks().trunk_m)).T, color=INK, lw=0.7, alpha=0.8, zorder=5)
    draw_robot(axes, scenario.robot, planar_pose(record.steps[-1].world.trunk), seen)
    draw_box(axes, record, seen)
    outlines = [box_at(record, step).corners() for step in record.pushing()]
    corners = seen.apply(np.concatenate([*outlines, box_footprint(scenario.box, scenario.goal.pose.pose()).corners()]))
    low, high = widen(corners.min(axis=0) - BEHIND_M, corners.max(axis=0) + BESIDE_M, ZOOM_ASPECT)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.set(xlabel=f"along the pushing direction of the {faces[0]} face at the goal [m]", ylabel="across [m]")
    axes.set_title(f"Pushes at the {', '.join(faces)} face{'s' * (len(faces) > 1)}")
