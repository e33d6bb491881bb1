"""What a tuning leaves behind: the best profile, a table of its trials, and a picture."""

import csv
import io
from collections.abc import Sequence
from math import ceil
from pathlib import Path
from typing import Final

import numpy as np

from agent_proc.figures import Axes, Figure, own_style, plain_log_ticks, save_figure
from agent_proc.profiles.profile import TunedOn, dump_profile
from agent_proc.studies.tuning.space import Space
from agent_proc.studies.tuning.trials import TrialEnd
from legpush.files import write_whole

BEST_FILE: Final = "best.toml"
TRIALS_FILE: Final = "trials.csv"
PICTURE_FILE: Final = "tuning.png"
N_COLUMNS: Final = 4
MOST_WORDS: Final = 14
"""Longest value that is written whole below a plot."""


def write_best(folder: Path, space: Space, best: TrialEnd, tuned_on: TunedOn) -> Path:
    """Write the profile of the best trial; returns the file.

    Raises:
        DiskError: It cannot be written.
    """
    description = f"{space.profile.description}; tuned: the best of its trials, number {best.number}"
    profile = space.profile_with(best.values, description=description, tuned_on=tuned_on)
    path = folder / BEST_FILE
    write_whole(path, dump_profile(profile).encode())
    return path


def write_trials(folder: Path, space: Space, ends: Sequence[TrialEnd]) -> Path:
    """Write the trials as CSV; returns the file.

    Raises:
        DiskError: It cannot be written.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["trial", "loss", "n_seeds", "given_up", *space.parameters])
    for end in ends:
        writer.writerow(
            [end.number, end.loss, end.n_seeds, end.pruned, *(end.values[path] for path in space.parameters)]
        )
    path = folder / TRIALS_FILE
    write_whole(path, text.getvalue().encode())
    return path


def save_picture(folder: Path, space: Space, ends: Sequence[TrialEnd]) -> Path:
    """Draw the loss over the trials and over each field; returns the file.

    Raises:
        OSError: It cannot be written.
    """
    path = folder / PICTURE_FILE
    n_rows = ceil((1 + len(space.parameters)) / N_COLUMNS)
    with own_style():
        figure = Figure(figsize=(3.2 * N_COLUMNS, 0.8 + 2.6 * n_rows), layout="constrained")
        axes = figure.subplots(n_rows, N_COLUMNS, squeeze=False).flatten()
        _over_trials(axes[0], ends)
        for axis, field in zip(axes[1:], space.parameters, strict=False):
            _over_values(axis, space, field, ends)
        for axis in axes[1 + len(space.parameters) :]:
            axis.set_axis_off()
        figure.suptitle(f"{len(ends)} trials, {sum(end.pruned for end in ends)} given up; loss of the tuning starts")
        save_figure(figure, path, dpi=110)
    return path


def _over_trials(axis: Axes, ends: Sequence[TrialEnd]) -> None:
    whole = [end for end in ends if not end.pruned]
    _points(axis, [float(end.number) for end in ends], ends)
    if whole:
        best = np.minimum.accumulate([end.loss for end in whole])
        axis.step([end.number for end in whole], best, where="post", color="tab:red", label="best")
    axis.set_title("trial", fontsize="medium")
    axis.legend(fontsize=8)


def _over_values(axis: Axes, space: Space, field: str, ends: Sequence[TrialEnd]) -> None:
    parameter = space.parameters[field]
    if parameter.choices is None:
        _points(axis, [float(str(end.values[field])) for end in ends], ends)
        if parameter.log:
            axis.set_xscale("log")
            plain_log_ticks(axis.xaxis)
            axis.tick_params(axis="x", labelsize=7)
    else:
        _points(axis, [float(parameter.choices.index(end.values[field])) for end in ends], ends)
        words = [str(choice)[:MOST_WORDS] for choice in parameter.choices]
        axis.set_xticks(range(len(words)), words)
        axis.set_xlim(-0.5, len(words) - 0.5)
    axis.set_title(field, fontsize="medium")


def _points(axis: Axes, x: Sequence[float], ends: Sequence[TrialEnd]) -> None:
    """A full point for each whole trial, an empty one for each that was given up."""
    for pruned, face, label in ((False, "tab:blue", "all seeds"), (True, "none", "given up")):
        chosen = [(at, end.loss) for at, end in zip(x, ends, strict=True) if end.pruned is pruned]
        if chosen:
            across, up = zip(*chosen, strict=True)
            axis.scatter(across, up, s=18, facecolors=face, edgecolors="tab:blue", label=label)
    axis.set_yscale("log")
    plain_log_ticks(axis.yaxis)
    axis.grid(alpha=0.3)
