"""Draws the table of a study: one plot per measure, with means and their intervals."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil
from pathlib import Path
from typing import Any, Final

import numpy as np

from agent_proc.figures import Axes, Figure, own_style, save_figure
from agent_proc.studies.table import PAIRED, Line
from legpush.errors import ConfigError

N_COLUMNS: Final = 3
MOST_MEASURES: Final = 12
"""Most plots in one picture."""
SPREAD: Final = 0.5
"""Share of the distance between two words over which the groups at one word are spread, so that none hides another."""
SPREAD_OF_NUMBERS: Final = 0.15
"""The same between two numbers, where a shift must not look like another number."""
MOST_TICKS: Final = 8
"""With at most this many numbers, each has its tick."""


def save_picture(lines: Sequence[Line], by: Sequence[str], title: str, path: Path) -> None:
    """Draw the first column of `by` along x, and the others as colours; write a PNG.

    Raises:
        ConfigError: There is nothing to draw, or there are more measures than fit into a picture.
    """
    measures = list(dict.fromkeys(line.measure for line in lines))
    if not 0 < len(measures) <= MOST_MEASURES:
        raise ConfigError(f"Expected 1 to {MOST_MEASURES} columns to draw, got {len(measures)}: choose with --measure")
    n_columns = min(N_COLUMNS, len(measures))
    n_rows = ceil(len(measures) / n_columns)
    with own_style():
        figure = Figure(figsize=(1.0 + 3.6 * n_columns, 1.0 + 3.0 * n_rows), layout="constrained")
        axes = figure.subplots(n_rows, n_columns, squeeze=False).flatten()
        for axis, measure in zip(axes, measures, strict=False):
            _draw(axis, [line for line in lines if line.measure == measure], by)
        for axis in axes[len(measures) :]:
            axis.set_axis_off()
        if by[1:]:
            handles, labels = axes[0].get_legend_handles_labels()
            n_across = min(len(labels), 4)
            figure.legend(handles, labels, loc="outside lower center", ncols=n_across, title=", ".join(by[1:]))
        figure.suptitle(title)
        save_figure(figure, path, dpi=110)


def _draw(axis: Axes, lines: Sequence[Line], by: Sequence[str]) -> None:
    """Draw one measure."""
    along = by[0] if by else None
    values = list({repr(_at(line, along)): _at(line, along) for line in lines}.values())
    numeric = len(values) > 1 and all(
        isinstance(value, int | float) and not isinstance(value, bool) for value in values
    )
    places: Mapping[str, float] = {repr(v): float(v) if numeric else float(i) for i, v in enumerate(values)}
    series: dict[str, list[Line]] = {}
    for line in lines:
        series.setdefault(", ".join(_shown(line.group[name]) for name in by[1:]), []).append(line)
    at = sorted(places.values())
    gap = min((b - a for a, b in pairwise(at)), default=1.0)
    for index, (label, found) in enumerate(series.items()):
        shift = (SPREAD_OF_NUMBERS if numeric else SPREAD) * gap * ((index + 0.5) / len(series) - 0.5)
        x = [places[repr(_at(line, along))] + shift for line in found]
        middle = [line.estimate.value for line in found]
        ends = np.array([line.estimate.ends for line in found]).T
        reach = np.maximum(np.array([[-1.0], [1.0]]) * (ends - np.array(middle)), 0.0)
        axis.errorbar(x, middle, reach, fmt="o", capsize=3, markersize=4, label=label)
    if not numeric or len(at) <= MOST_TICKS:
        axis.set_xticks(list(places.values()), [_shown(value) for value in values])
    if not numeric:
        axis.set_xlim(min(at) - 0.6, max(at) + 0.6)
    if lines[0].how.startswith(PAIRED):
        axis.axhline(0.0, color="0.6", linewidth=1.0, zorder=0)
    axis.set_title(lines[0].title, fontsize="medium")
    axis.set_xlabel(along or "")
    axis.grid(axis="y", alpha=0.3)


def _at(line: Line, name: str | None) -> Any:
    return "all" if name is None else line.group[name]


def _shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    return "x".join(map(_shown, value)) if isinstance(value, list) else str(value)
