"""The picture of an evaluation: final errors of each case, every episode a dot."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from agent_proc.evaluation import Row, mean_interval

JITTER: Final = 0.12


def save_plot(rows: Sequence[Row], title: str, path: Path) -> None:
    """Position and angle errors over the cases, with means and their 95 % intervals, as a PNG."""
    cases = list(dict.fromkeys(row.case for row in rows))
    figure = Figure(figsize=(max(5.0, 1.2 * len(cases) + 3.0), 6.0), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True)
    panels = (
        ("position error [cm]", [100 * row.position_error_m for row in rows]),
        ("angle error [deg]", [row.angle_error_deg for row in rows]),
    )
    scatter = np.random.default_rng(0).uniform(-JITTER, JITTER, len(rows))
    at = np.array([cases.index(row.case) for row in rows])
    for axis, (label, values) in zip(axes, panels, strict=True):
        axis.plot(at + scatter, values, ".", color="tab:blue", alpha=0.5, label="episode")
        for index in range(len(cases)):
            mean = mean_interval([value for value, place in zip(values, at, strict=True) if place == index])
            spread = [[mean.value - mean.low], [mean.high - mean.value]]
            label_once = "mean, 95 % interval" if index == 0 else None
            axis.errorbar(index, mean.value, spread, fmt="o", color="tab:red", capsize=4, label=label_once)
        axis.set_ylabel(label)
        axis.set_ylim(bottom=0.0)
        axis.grid(axis="y", alpha=0.3)
    axes[0].legend()
    axes[0].set_title(f"{title}, {len(rows) // len(cases)} episodes each")
    axes[1].set_xticks(range(len(cases)), [case.replace(" ", "\n") or "as it is" for case in cases])
    figure.savefig(path, dpi=110)
