"""Learning curves of trainings: of each seed, and their mean over the seeds with its interval."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Final

import numpy as np

from agent_proc.figures import Axes, Figure, own_style, plain_log_ticks, save_figure
from agent_proc.policies.card import CurvePoint
from agent_proc.statistics.estimate import CUT, Estimate
from agent_proc.statistics.intervals import STUDENT_T, mean, mean_curve
from legpush.arrays import Floats
from legpush.errors import ConfigError

WINDOW: Final = 30
"""Episodes over which a curve is a mean, as the progress of a training shows them."""
N_POINTS: Final = 100
"""Points of a curve."""
MEASURES: Final = ("episode_return", "success", "position_error_m", "angle_error_deg")
TITLES: Final = {
    "episode_return": ("return", 1.0),
    "success": ("success [%]", 100.0),
    "position_error_m": ("position error [cm]", 100.0),
    "angle_error_deg": ("angle error [°]", 1.0),
}
POSSIBLE: Final = {
    "episode_return": (-inf, inf),
    "success": (0.0, 1.0),
    "position_error_m": (0.0, inf),
    "angle_error_deg": (0.0, inf),
}
"""Least and most that a measure can be. Student's interval of few values may reach beyond."""
LOGARITHMIC: Final = ("position_error_m", "angle_error_deg")


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """Curves of the trainings of one contestant over equal steps."""

    label: str
    steps: Floats
    """(k,): push cycles."""
    seeds: dict[str, Floats]
    """By measure: (trainings, k)."""

    def end(self, name: str) -> Estimate:
        """Mean of the last values of a measure over the trainings."""
        return mean(self.seeds[name][:, -1].tolist()).cut(*POSSIBLE[name])


def make_curve(label: str, trainings: Sequence[Sequence[CurvePoint]]) -> Curve:
    """Compute the curves from the episodes of each training, over the steps that all of them have.

    Raises:
        ConfigError: A training has fewer episodes than the window.
    """
    if (shortest := min(map(len, trainings))) < WINDOW:
        raise ConfigError(f"{label}: expected trainings of {WINDOW} episodes or more for their curves, got {shortest}")
    steps = [np.array([point.step for point in points[WINDOW - 1 :]], dtype=np.float64) for points in trainings]
    grid = np.linspace(max(each[0] for each in steps), min(each[-1] for each in steps), N_POINTS)
    seeds = {
        name: np.stack(
            [np.interp(grid, at, _moving_mean(points, name)) for at, points in zip(steps, trainings, strict=True)]
        )
        for name in MEASURES
    }
    return Curve(label=label, steps=grid, seeds=seeds)


def save_curves(curves: Sequence[Curve], path: Path) -> None:
    """Draw each training, and the mean over the seeds with its interval; writes a PNG.

    Raises:
        OSError: It cannot be written.
    """
    with own_style():
        figure = Figure(figsize=(11.0, 7.0), layout="constrained")
        for axis, name in zip(figure.subplots(2, 2, sharex=True).flatten(), MEASURES, strict=True):
            title, scale = TITLES[name]
            for index, curve in enumerate(curves):
                _draw(axis, curve, name, scale, f"C{index}")
            axis.set_ylabel(title)
            axis.grid(alpha=0.3)
            if name == "success":
                axis.set_ylim(-2.0, 102.0)
            if name in LOGARITHMIC:
                axis.set_yscale("log")
                plain_log_ticks(axis.yaxis)
        figure.axes[0].legend(fontsize=8)
        for axis in figure.axes[2:]:
            axis.set_xlabel("push cycles")
        figure.suptitle(
            f"Mean over {WINDOW} episodes of the training: each seed, mean over seeds with {STUDENT_T}, {CUT}"
        )
        save_figure(figure, path, dpi=110)


def _moving_mean(points: Sequence[CurvePoint], name: str) -> Floats:
    values = np.array([float(getattr(point, name)) for point in points])
    found: Floats = np.convolve(values, np.full(WINDOW, 1.0 / WINDOW), mode="valid")
    return found


def _draw(axis: Axes, curve: Curve, name: str, scale: float, colour: str) -> None:
    values = curve.seeds[name]
    n = len(values)
    middle, low, high = mean_curve(values)
    label = f"{curve.label}, {n} seed{'s' if n > 1 else ''}"
    axis.plot(curve.steps, scale * middle, color=colour, linewidth=2, label=label)
    if n > 1:
        for each in values:
            axis.plot(curve.steps, scale * each, color=colour, linewidth=0.7, alpha=0.4)
        least, most = POSSIBLE[name]
        # A logarithmic axis ends above 0: there the interval reaches below all curves.
        least = max(least, values.min() / 2) if name in LOGARITHMIC else least
        low, high = (scale * np.clip(end, least, most) for end in (low, high))
        axis.fill_between(curve.steps, low, high, color=colour, alpha=0.15)
