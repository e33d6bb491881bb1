"""Draws a comparison: interquartile means, profiles, probabilities of improvement, and paired differences."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from agent_proc.figures import Axes, Figure, own_style, save_figure
from agent_proc.statistics.estimate import Estimate
from agent_proc.studies.comparison.outcome import THRESHOLDS, Outcome

GREY: Final = "0.55"
"""Of the contestant that the others are compared with, and of lines that help the eye."""


def save_picture(outcome: Outcome, title: str, path: Path) -> None:
    """Draw four panels and write a PNG.

    Raises:
        OSError: It cannot be written.
    """
    labels = [entry.label for entry in outcome.entries]
    colours = {label: f"C{index}" for index, label in enumerate(labels)}
    with own_style():
        figure = Figure(figsize=(11.0, 2.4 + 0.9 * len(labels)), layout="constrained")
        (iqm, curves), (better, success) = figure.subplots(2, 2)
        _bars(iqm, labels, [entry.loss_iqm for entry in outcome.entries], colours)
        iqm.set_title("interquartile mean of the loss (less is better)")
        iqm.set_xscale("log")
        iqm.set_xlim(0.02, 12.0)
        iqm.set_xticks([0.1, 1.0, 10.0], ["0.1", "1", "10"])
        iqm.axvline(1.0, color=GREY, linewidth=1.0, zorder=0)
        for entry in outcome.entries:
            _profile(curves, entry.loss_profile, entry.label, colours[entry.label])
        curves.axvline(1.0, color=GREY, linewidth=1.0, zorder=0)
        curves.set_xscale("log")
        curves.set_xticks([0.01, 0.1, 1.0, 10.0], ["0.01", "0.1", "1", "10"])
        curves.set_ylim(0.0, 1.02)
        curves.set_title("share of episodes with at most this loss")
        curves.set_xlabel("loss: the larger error, in tolerances")
        curves.legend(fontsize=8)
        versus = list(outcome.versus)
        _bars(better, [each.label for each in versus], [each.improvement for each in versus], colours)
        better.axvline(0.5, color=GREY, linewidth=1.0, zorder=0)
        better.set_xlim(-0.02, 1.02)
        better.set_title(f"probability of a lower loss than {outcome.against}")
        shares = [entry.means["success"].scaled(100.0) for entry in outcome.entries]
        _bars(success, labels, shares, colours)
        success.set_xlim(-2.0, 102.0)
        success.set_title("success [%]")
        figure.suptitle(title)
        save_figure(figure, path, dpi=110)


def _bars(axis: Axes, labels: Sequence[str], estimates: Sequence[Estimate], colours: dict[str, str]) -> None:
    """A point with its interval for each label, the first one on top."""
    for place, (label, estimate) in enumerate(zip(labels, estimates, strict=True)):
        low, high = estimate.ends
        reach = np.array([[estimate.value - low], [high - estimate.value]])
        axis.errorbar(estimate.value, -place, xerr=np.maximum(reach, 0.0), fmt="o", capsize=4, color=colours[label])
    axis.set_yticks([-place for place in range(len(labels))], list(labels))
    axis.set_ylim(-len(labels) + 0.4, 0.6)
    axis.grid(axis="x", alpha=0.3)


def _profile(axis: Axes, shares: Sequence[Estimate], label: str, colour: str) -> None:
    middle = [each.value for each in shares]
    ends = np.array([each.ends for each in shares])
    axis.plot(THRESHOLDS, middle, color=colour, label=label)
    axis.fill_between(THRESHOLDS, ends[:, 0], ends[:, 1], color=colour, alpha=0.15)
    axis.grid(alpha=0.3)
