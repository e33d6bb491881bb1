"""`python -m experiments.learning`: draws what `python -m experiments.trainings` measured.

`results/learning_curves.png` is the counterpart of Figs. 14 and 15: the return of episodes as a moving average over 30,
as mean over the training seeds with its 95 % interval, for the published and the tuned profile and for fixed and
variable entry. `results/learning_comparison.png` compares network sizes, algorithms and randomization by the errors at
the ends of episodes. `results/learning_speed.csv` says how fast each training of the tuned profile learns, and
`results/learning_end.csv` how large the errors in the last episodes of the trainings are, as mean over the seeds.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from agent_proc.statistics.intervals import mean_curve, mean_of_groups
from experiments.evaluations import RESULTS, plain_ticks, write_table
from experiments.trainings import read_episodes
from legpush.arrays import Floats

WINDOW: Final = 30
"""Episodes of the moving average, as published."""
SHARE: Final = 0.9
"""Share of the final value that defines the speed of learning."""
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


def main() -> None:
    """Write the tables and draw both pictures."""
    by_variant = _by_variant()
    for rows, name in ((speed_rows(by_variant), "learning_speed.csv"), (end_rows(by_variant), "learning_end.csv")):
        write_table(rows, RESULTS / name)
        for row in rows:
            print(row)
    draw_curves(by_variant)
    draw_comparison(by_variant)


def _by_variant() -> dict[str, dict[int, list[dict[str, float]]]]:
    """Return the episodes of each seed of each variant, in order."""
    found: dict[str, dict[int, list[dict[str, float]]]] = {}
    for row in read_episodes():
        numbers = {key: float(value) for key, value in row.items() if key not in ("study", "variant")}
        found.setdefault(row["variant"], {}).setdefault(int(row["seed"]), []).append(numbers)
    return found


def moving_average(values: Sequence[float]) -> Floats:
    """Return the means of the last `WINDOW` values, from the first full window on, (n - WINDOW + 1,)."""
    means: Floats = np.convolve(np.array(values), np.full(WINDOW, 1 / WINDOW), mode="valid")
    return means


def speed_rows(by_variant: Mapping[str, Mapping[int, list[dict[str, float]]]]) -> list[dict[str, Any]]:
    """Return, for each training of the tuned profile, after how many episodes the average has `SHARE` of its final
    value."""
    rows = []
    for variant in ("tuned-fixed", "tuned-variable"):
        for seed, episodes in by_variant.get(variant, {}).items():
            average = moving_average([row["return"] for row in episodes])
            reached = int(np.argmax(average >= SHARE * average[-1])) + WINDOW
            rows.append(
                {
                    "variant": variant,
                    "seed": seed,
                    "episodes": len(episodes),
                    "first_average": round(float(average[0]), 3),
                    "final_average": round(float(average[-1]), 3),
                    "episodes_to_90_percent": reached,
                    "steps_to_90_percent": int(episodes[reached - 1]["step"]),
                }
            )
    return rows


def end_rows(by_variant: Mapping[str, Mapping[int, list[dict[str, float]]]]) -> list[dict[str, Any]]:
    """Return, for each variant, the means over the training seeds of the means over the last `WINDOW` episodes."""
    rows = []
    for variant, seeds in by_variant.items():
        ends = [episodes[-WINDOW:] for episodes in seeds.values()]
        row: dict[str, Any] = {"variant": variant, "episodes_each": WINDOW}
        for key, n_digits in (("position_error_m", 5), ("angle_error_deg", 3)):
            row |= mean_of_groups([[one[key] for one in end] for end in ends]).columns(key, n_digits)
        rows.append(row)
    return rows


def draw_curves(by_variant: Mapping[str, Mapping[int, list[dict[str, float]]]]) -> None:
    """Draw a panel for each profile and entry."""
    figure = Figure(figsize=(10.0, 6.4), layout="constrained")
    for row, profile in zip(figure.subplots(2, 2), ("paper", "tuned"), strict=True):
        for axis, entry in zip(row, ("fixed", "variable"), strict=True):
            seeds = by_variant.get(f"{profile}-{entry}", {})
            _draw_panel(axis, seeds)
            axis.set_title(f"profile {profile}, {entry} entry, {len(seeds)} seeds")
            axis.set_xlabel("episode")
            axis.set_ylabel("return")
            axis.grid(alpha=0.25)
    figure.suptitle(f"Moving average over {WINDOW} episodes: each seed, mean with Student's t 95 %")
    figure.savefig(RESULTS / "learning_curves.png", dpi=110)


def _draw_panel(axis: Axes, seeds: Mapping[int, list[dict[str, float]]]) -> None:
    averages = [moving_average([row["return"] for row in rows]) for rows in seeds.values() if len(rows) >= WINDOW]
    for average in averages:
        axis.plot(np.arange(len(average)) + WINDOW, average, color="tab:blue", alpha=0.25, linewidth=1)
    if len(averages) < len(("a", "b")):
        return
    shortest = min(map(len, averages))
    stacked = np.stack([average[:shortest] for average in averages])
    mean, low, high = mean_curve(stacked)
    episode = np.arange(shortest) + WINDOW
    axis.plot(episode, mean, color="tab:blue", linewidth=2)
    axis.fill_between(episode, low, high, color="tab:blue", alpha=0.2)


def draw_comparison(by_variant: Mapping[str, Mapping[int, list[dict[str, float]]]]) -> None:
    """Draw the median errors of the last `WINDOW` episodes over push cycles, as geometric mean over seeds."""
    figure = Figure(figsize=(12.0, 7.0), layout="constrained")
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
        axes[0, column].legend(fontsize=8)
        axes[1, column].set_xlabel("push cycles")
    figure.suptitle(
        f"Errors while learning: median of {WINDOW} episodes, geometric mean of seeds with Student's t 95 %"
    )
    figure.savefig(RESULTS / "learning_comparison.png", dpi=110)


def _over_steps(seeds: Mapping[int, list[dict[str, float]]], key: str, scale: float) -> tuple[Floats, Floats]:
    """Return a grid of steps and, for each seed, a curve over it."""
    ends, begins, curves = [], [], []
    for rows in seeds.values():
        steps = np.array([row["step"] for row in rows[WINDOW - 1 :]])
        windows = np.lib.stride_tricks.sliding_window_view([scale * row[key] for row in rows], WINDOW)
        curves.append((steps, np.median(windows, axis=1)))
        begins.append(steps[0])
        ends.append(steps[-1])
    grid = np.arange(max(begins), min(ends), GRID, dtype=np.float64)
    return grid, np.stack([np.interp(grid, steps, values) for steps, values in curves])


if __name__ == "__main__":
    main()
