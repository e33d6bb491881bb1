"""The plots of the page: curves of a whole episode, with a line at the moment that is shown."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import viser

from legpush.arrays import Floats, Indices
from legpush.history.timeline import Timeline
from legpush.scene.conventions import JOINTS

MAX_POINTS: Final = 400
"""Most points of a curve. More could not be seen."""
HEIGHT: Final = 140
"""Height of a plot in pixels."""
FONT: Final = "11px sans-serif"
LABEL_SIZE: Final = 14
"""Space for the label of an axis in pixels."""
NOW_GREY: Final = "#6b7280"


@dataclass(frozen=True, kw_only=True)
class Curve:
    """One line of a plot."""

    label: str
    color: str
    scale: str = "y"
    """The axis: `y` on the left or `y2` on the right."""


def rewards(timeline: Timeline, rows: Indices) -> Floats:
    """Reward of the step that led to each row; 0 if none is known."""
    starts = np.array([step.first_row for step in timeline.steps])
    earned = np.array([timeline.rewards.get(step.number, 0.0) for step in timeline.steps])
    found: Floats = earned[np.searchsorted(starts, rows, side="right") - 1]
    return found


def chosen_rows(n_rows: int) -> Indices:
    """At most `MAX_POINTS` rows, including the first and the last."""
    return np.unique(np.linspace(0, n_rows - 1, min(n_rows, MAX_POINTS)).round().astype(np.intp))


def box_errors(timeline: Timeline, rows: Indices) -> tuple[Floats, ...]:
    """Errors of the box in position [cm] and angle [deg]."""
    error = timeline.box_error(rows)
    return 100.0 * error[:, 0], np.degrees(error[:, 1])


def trunk_angles(timeline: Timeline, rows: Indices) -> tuple[Floats, ...]:
    """Roll and pitch of the trunk [deg]."""
    angles = np.degrees(timeline.roll_pitch_rad[rows])
    return angles[:, 0], angles[:, 1]


def margins(timeline: Timeline, rows: Indices) -> tuple[Floats, ...]:
    """Least margins of capture point, zero-moment point and CoM from each row to the next [cm]."""
    of_points = (timeline.capture_margin_m, timeline.zmp_margin_m, timeline.support_margin_m)
    return tuple(100.0 * np.fmin.reduceat(values, rows) for values in of_points)


def torques(timeline: Timeline, rows: Indices) -> tuple[Floats, ...]:
    """Largest torques of the hip-x, hip-y and knee joints of all legs from each row to the next [N m]."""
    magnitudes = np.abs(timeline.joint_torques_n_m)
    kinds = (magnitudes[:, index :: len(JOINTS)].max(axis=1) for index in range(len(JOINTS)))
    return tuple(np.fmax.reduceat(values, rows) for values in kinds)


@dataclass(frozen=True, kw_only=True)
class Plot:
    """A plot over simulated time."""

    title: str
    curves: tuple[Curve, ...]
    units: tuple[str, ...]
    """Labels of the axes at the left and, if there is one, at the right."""
    values: Callable[[Timeline, Indices], tuple[Floats, ...]]
    """A function to the values of each curve at some rows; unknown values are NaN."""


PLOTS: Final = (
    Plot(
        title="Box error",
        curves=(Curve(label="position [cm]", color="#7e46aa"), Curve(label="angle [deg]", color="#d97b0d", scale="y2")),
        units=("cm", "deg"),
        values=box_errors,
    ),
    Plot(
        title="Reward of each push",
        curves=(Curve(label="reward", color="#188c50"),),
        units=("reward",),
        values=lambda timeline, rows: (rewards(timeline, rows),),
    ),
    Plot(
        title="Trunk angles",
        curves=(Curve(label="roll [deg]", color="#cd3c2d"), Curve(label="pitch [deg]", color="#285aa0")),
        units=("deg",),
        values=trunk_angles,
    ),
    Plot(
        title="Margins in the support polygon [cm]",
        curves=(
            Curve(label="capture point", color="#d97b0d"),
            Curve(label="ZMP", color="#8c33a6"),
            Curve(label="CoM", color="#2369c8"),
        ),
        units=("cm",),
        values=margins,
    ),
    Plot(
        title="Largest torque of any leg [N m]",
        curves=(
            Curve(label="hip-x", color="#188c50"),
            Curve(label="hip-y", color="#cd3c2d"),
            Curve(label="knee", color="#285aa0"),
        ),
        units=("N m",),
        values=torques,
    ),
)


class Plots:
    """All plots, in the current container of the page."""

    def __init__(self, server: viser.ViserServer) -> None:
        """Create empty plots."""
        nothing = np.zeros(1)
        self._handles: list[Any] = []
        self._drawn: object = None
        for plot in PLOTS:
            series: list[dict[str, Any]] = [{"label": "t [s]"}]
            series += [{"stroke": c.color, "width": 1.5, "scale": c.scale, "label": c.label} for c in plot.curves]
            series.append({"stroke": NOW_GREY, "width": 1.5, "scale": "now", "label": "now"})
            axes: list[dict[str, Any]] = [_axis("t [s]", 26), {"scale": "y", **_axis(plot.units[0], 44)}]
            if len(plot.units) > 1:
                axes.append({"scale": "y2", "side": 1, "grid": {"show": False}, **_axis(plot.units[1], 36)})
            handle = server.gui.add_uplot(
                (nothing,) * (2 + len(plot.curves)),
                tuple(series),  # type: ignore[arg-type]
                title=plot.title,
                scales={"x": {"time": False}, "now": {"range": (0.0, 1.0)}},
                axes=tuple(axes),  # type: ignore[arg-type]
                legend={"show": True, "live": False},
                height=HEIGHT,
            )
            self._handles.append(handle)

    def show(self, timeline: Timeline, row: int) -> None:
        """Draw a timeline, with the line of the present at a row."""
        source = (id(timeline), timeline.n_rows, len(timeline.rewards), row)
        if source == self._drawn:
            return
        self._drawn = source
        rows = np.sort(np.concatenate([chosen_rows(timeline.n_rows), [row, row]]))
        time_s = timeline.time_s[rows]
        now = np.full(len(rows), np.nan)
        first = int(np.searchsorted(rows, row))
        now[first : first + 2] = 0.0, 1.0
        for plot, handle in zip(PLOTS, self._handles, strict=True):
            handle.data = (time_s, *map(begun, plot.values(timeline, rows)), now)


def _axis(label: str, size: int) -> dict[str, Any]:
    """An axis with its label; `size` is the space for its numbers in pixels."""
    return {"label": label, "labelSize": LABEL_SIZE, "labelFont": FONT, "size": size, "font": FONT}


def begun(values: Floats) -> Floats:
    """Put the first known value at the beginning of a curve, because charts find no scale if it begins with NaN."""
    known = values[np.isfinite(values)]
    return np.concatenate([known[:1], values[1:]]) if len(known) else values
