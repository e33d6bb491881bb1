"""Pictures of the trainings: learning curves, and errors by size of the network, algorithm and randomization."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from agent_proc.figures import Axes, Figure, legend_below
from agent_proc.statistics.intervals import mean_curve
from experiments.rows import Row
from experiments.tables.learning import WINDOW, Variants, moving_average, read_trainings, variants
from experiments.tables.parts import plain_ticks
from legpush.arrays import Floats

GRID: Final = 64
"""Pushes between two points of a curve over steps."""
LEAST_SEEDS: Final = 3
"""Fewest seeds for which an interval is drawn."""
SHOWN: Final = {"position_error_m": (0.1, 20.0), "angle_error_deg": (0.05, 20.0)}
"""Limits of the axes, in cm and degrees."""
COMPARED: Final = {
    "2x64 (tuned)": "tuned-variable",
    "2x128": "network-2x128",
    "4x64": "network-4x64",
    "4x512": "network-4x512",
    "SAC": "sac",
    "TD3": "td3",
    "PPO, randomized": "randomized",
}
"""Variant of each label."""


def pictures() -> dict[str, Figure]:
    """Draw the curves and the comparison."""
    by_variant = variants(read_trainings())
    return {"learning_curves.png": _curves(by_variant), "learning_comparison.png": _comparison(by_variant)}


def _curves(by_variant: Variants) -> Figure:
    """Draw a panel for each profile and entry."""
    figure = Figure(figsize=(10.0, 6.4), layout="constrained", dpi=110)
    for row, profile in zip(figure.subplots(2, 2), ("paper", "tuned"), strict=True):
        for axis, entry in zip(row, ("fixed", "variable"), strict=True):
            seeds = by_variant.get(f"{profile}-{entry}", {})
            draw_average(axis, [each["episode_return"] for each in seeds.values()])
            axis.set_title(f"profile {profile}, {entry} entry, {len(seeds)} seeds")
            axis.set_ylabel("return")
    figure.suptitle(f"Moving average over {WINDOW} episodes: each seed, mean with Student's t 95 %")
    return figure


def draw_average(axis: Axes, values: Sequence[Sequence[float]]) -> None:
    """Draw the moving average of each training and, as far as all of them go, the mean with its interval."""
    averages = [moving_average(each) for each in values if len(each) >= WINDOW]
    for average in averages:
        axis.plot(np.arange(len(average)) + WINDOW, average, color="tab:blue", alpha=0.3, linewidth=1)
    if len(averages) > 1:
        shortest = min(map(len, averages))
        mean, low, high = mean_curve(np.stack([average[:shortest] for average in averages]))
        episode = np.arange(shortest) + WINDOW
        axis.plot(episode, mean, color="tab:blue", linewidth=2)
        if len(averages) >= LEAST_SEEDS:
            axis.fill_between(episode, low, high, color="tab:blue", alpha=0.2)
    axis.set_xlabel("episode")
    axis.grid(alpha=0.25)


def _comparison(by_variant: Variants) -> Figure:
    """Draw the median errors of the last `WINDOW` episodes over push cycles, as geometric mean over seeds."""
    figure = Figure(figsize=(12.0, 7.0), layout="constrained", dpi=110)
    axes = figure.subplots(2, 3, sharex=True, sharey="row")
    groups = (
        ("network size", ("2x64 (tuned)", "2x128", "4x64", "4x512")),
        ("algorithm", ("2x64 (tuned)", "SAC", "TD3")),
        ("randomization", ("2x64 (tuned)", "PPO, randomized")),
    )
    measures = (("position error [cm]", "position_error_m", 100.0), ("angle error [deg]", "angle_error_deg", 1.0))
    for column, (title, labels) in enumerate(groups):
        for axis, (name, key, scale) in zip(axes[:, column], measures, strict=True):
            for label in labels:
                seeds = by_variant.get(COMPARED[label], {})
                if seeds:
                    steps, curves = _over_steps(seeds, key, scale)
                    mean, low, high = np.exp(mean_curve(np.log(curves)))
                    (line,) = axis.plot(steps, mean, label=f"{label}, {len(seeds)} seeds")
                    if len(seeds) >= LEAST_SEEDS:
                        axis.fill_between(steps, low, high, color=line.get_color(), alpha=0.15)
            axis.set_yscale("log")
            axis.set_ylim(*SHOWN[key])
            plain_ticks(axis)
            axis.set_ylabel(name)
            axis.grid(which="both", alpha=0.25)
        axes[0, column].set_title(title)
        axes[1, column].set_xlabel("push cycles")
        legend_below(axes[1, column], n_columns=2)
    figure.suptitle(
        f"Errors while learning: median of {WINDOW} episodes, geometric mean of seeds with Student's t 95 %"
    )
    return figure


def _over_steps(seeds: Mapping[int, Row], key: str, scale: float) -> tuple[Floats, Floats]:
    """Return a grid of steps and, for each seed, a curve over it."""
    ends, begins, curves = [], [], []
    for row in seeds.values():
        steps = np.array(row["episode_step"][WINDOW - 1 :])
        windows = np.lib.stride_tricks.sliding_window_view(scale * np.array(row[f"episode_{key}"]), WINDOW)
        curves.append((steps, np.median(windows, axis=1)))
        begins.append(steps[0])
        ends.append(steps[-1])
    grid = np.arange(max(begins), min(ends), GRID, dtype=np.float64)
    return grid, np.stack([np.interp(grid, steps, values) for steps, values in curves])
