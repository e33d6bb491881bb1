"""Draws an evaluation: final errors of every episode by case, or means over a grid of two fields."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from agent_proc.evaluation.episodes import Row
from agent_proc.evaluation.sweep import Sweep
from agent_proc.figures import Axes, Figure, own_style, save_figure
from agent_proc.statistics.estimate import kinds_in_words
from agent_proc.statistics.intervals import mean
from legpush.arrays import Floats

JITTER: Final = 0.12
MARGIN: Final = 0.1
"""At both sides of the columns, whose width is 1."""
MEASURES: Final[tuple[tuple[str, Callable[[Row], float]], ...]] = (
    ("position error [cm]", lambda row: 100 * row.position_error_m),
    ("angle error [deg]", lambda row: row.angle_error_deg),
    ("success [%]", lambda row: 100.0 * row.success),
)


def save_plot(rows: Sequence[Row], sweep: Sweep, title: str, path: Path) -> None:
    """Draw the errors by case with means and 95 % intervals, or maps over a grid of two fields, and write a PNG."""
    draw = _maps if sweep.grid and len(sweep.fields) == len(("x", "y")) else _columns
    with own_style():
        figure = draw(rows, sweep)
        figure.suptitle(f"{title}, {len(rows) // len(sweep.cases)} episodes each")
        save_figure(figure, path, dpi=110)


def _columns(rows: Sequence[Row], sweep: Sweep) -> Figure:
    """Position and angle errors; each case is a column of dots."""
    cases = list(sweep.cases)
    figure = Figure(figsize=(max(7.0, 1.2 * len(cases) + 3.0), 6.0), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True)
    scatter = np.random.default_rng(0).uniform(-JITTER, JITTER, len(rows))
    at = np.array([cases.index(row.case) for row in rows])
    for axis, (label, measure) in zip(axes, MEASURES[:2], strict=True):
        values = np.array([measure(row) for row in rows])
        axis.plot(at + scatter, values, ".", color="tab:blue", alpha=0.5, label="episode")
        means = [mean(values[at == index].tolist()) for index in range(len(cases))]
        middle, ends = np.array([one.value for one in means]), np.array([one.ends for one in means]).T
        kinds = kinds_in_words(one.kind for one in means)
        reach = np.abs(ends - middle)
        axis.errorbar(range(len(cases)), middle, reach, fmt="o", color="tab:red", capsize=4, label=f"mean, {kinds}")
        axis.set_ylabel(label)
        axis.set_ylim(bottom=0.0)
        axis.grid(axis="y", alpha=0.3)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    axes[1].set_xlim(-0.5 - MARGIN, len(cases) - 0.5 + MARGIN)
    axes[1].set_xticks(range(len(cases)), [case.replace(" ", "\n") or "as it is" for case in cases])
    return figure


def _maps(rows: Sequence[Row], sweep: Sweep) -> Figure:
    """A map of each measure over the two fields with the mean of each cell; an error of one tolerance is red."""
    goal = next(iter(sweep.cases.values())).goal
    reds = (100 * goal.position_tolerance_m, goal.angle_tolerance_deg, 0.0)
    columns = {case: sweep.columns(case) for case in sweep.cases}
    across, up = (list(dict.fromkeys(values[field] for values in columns.values())) for field in sweep.fields)
    figure = Figure(figsize=(4.0 * len(MEASURES), 1.2 + 0.6 * len(up) + 1.0), layout="constrained")
    for axis, (label, measure), red in zip(figure.subplots(1, len(MEASURES)), MEASURES, reds, strict=True):
        cells = np.full((len(up), len(across)), np.nan)
        for case, values in columns.items():
            place = up.index(values[sweep.fields[1]]), across.index(values[sweep.fields[0]])
            cells[place] = np.mean([measure(row) for row in rows if row.case == case])
        _draw_map(axis, cells, red=red, green=100.0 if red == 0.0 else 0.0)
        axis.set_title(label)
        axis.set_xticks(range(len(across)), [str(value) for value in across])
        axis.set_yticks(range(len(up)), [str(value) for value in up])
        axis.set_xlabel(sweep.fields[0])
        axis.set_ylabel(sweep.fields[1])
    return figure


def _draw_map(axis: Axes, cells: Floats, *, red: float, green: float) -> None:
    colors, low, high = ("RdYlGn", red, green) if red < green else ("RdYlGn_r", green, red)
    axis.imshow(cells, cmap=colors, vmin=low, vmax=high, origin="lower", aspect="auto", alpha=0.8)
    for (row, column), value in np.ndenumerate(cells):
        axis.text(column, row, f"{value:.3g}", ha="center", va="center")
