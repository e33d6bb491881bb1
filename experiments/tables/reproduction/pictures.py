"""Pictures of the reproduction: curves as in Figs. 14 and 15, the published code, the factorial, and the ladder."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from agent_proc.figures import Axes, Figure, legend_below
from experiments.rows import Row
from experiments.tables.learning import WINDOW
from experiments.tables.learning_pictures import draw_average
from experiments.tables.parts import plain_ticks
from experiments.tables.reproduction.factorial import combination, rungs
from experiments.tables.reproduction.summaries import grouped
from experiments.tables.reproduction.tables import LADDER, MAP, TRAININGS, read_studies
from legpush.arrays import Floats

ENDS: Final = {
    "paper-text": ("within the tolerances alone", "tab:red"),
    "release": ("the published code's", "tab:orange"),
    "paper-learns": ("within the tolerances or past the goal", "tab:blue"),
}
"""Words and colour of each end."""
FRAMES: Final = {"paper-text": "the paper's observation, metres of the world", "paper-learns": "the goal's frame"}
COLUMNS: Final = {
    (False, 2048): "as measured,\n4 updates",
    (False, 256): "as measured,\n32 updates",
    (True, 2048): "normalized,\n4 updates",
    (True, 256): "normalized,\n32 updates",
}
"""Places along the axis of the factorial."""
TOLERANCE_CM: Final = 3.0
SPREAD: Final = 0.18
"""Distance between the points of two ends, in columns."""


def pictures() -> dict[str, Figure]:
    """Draw all pictures."""
    studies = read_studies()
    factorial, ladder = studies[MAP].rows, studies[LADDER].rows
    learns = [studies[TRAININGS[f"learns_{entry}"]].rows for entry in ("fixed", "variable_simulator")]
    return {
        "reproduction_curves.png": curves_figure(*learns),
        "reproduction_release.png": release_figure(rungs(ladder, factorial)[0][1]),
        "reproduction_map.png": factorial_figure(factorial),
        "reproduction_ladder.png": ladder_figure(rungs(ladder, factorial)),
    }


def curves_figure(fixed: Sequence[Row], variable: Sequence[Row]) -> Figure:
    """Draw the counterparts of Figs. 14 and 15."""
    figure = Figure(figsize=(10.0, 3.8), layout="constrained", dpi=110)
    panels = (("fixed entry (Fig. 14)", fixed), ("variable entry (Fig. 15)", variable))
    for axis, (title, rows) in zip(figure.subplots(1, 2), panels, strict=True):
        world = "simulator" if rows[0]["world"] == "mujoco" else "without physics"
        draw_average(axis, [row["episode_return"] for row in rows])
        axis.set_title(f"{title}, {world}, {len(rows)} trainings")
        axis.set_ylabel("return")
    figure.suptitle(f"paper-learns: moving average over {WINDOW} episodes, mean and Student's t 95 % over trainings")
    return figure


def release_figure(rows: Sequence[Row]) -> Figure:
    """Draw the return of the published code beside what its policies do, in the world without physics."""
    figure = Figure(figsize=(10.0, 3.8), layout="constrained", dpi=110)
    returns, errors = figure.subplots(1, 2)
    draw_average(returns, [row["episode_return"] for row in rows])
    returns.set_title("its return")
    returns.set_ylabel("return")
    draw_average(errors, [[100.0 * value for value in row["episode_position_error_m"]] for row in rows])
    last = 100.0 * np.array([np.mean(row["final_position_error_m"]) for row in rows])
    n_episodes = max(len(row["episode_return"]) for row in rows)
    errors.plot(np.full(len(last), 1.04 * n_episodes), last, "D", color="tab:red", label="last policies, other starts")
    errors.axhline(TOLERANCE_CM, color="black", linestyle=":", linewidth=1, label="3 cm")
    errors.set_title("and where the box ends")
    errors.set_ylabel("position error at the end [cm]")
    errors.set_ylim(bottom=0.0)
    legend_below(errors, n_columns=3)
    figure.suptitle(f"The published code without physics, {len(rows)} trainings: moving average over {WINDOW} episodes")
    return figure


def factorial_figure(rows: Sequence[Row]) -> Figure:
    """Draw the error of each training of the factorial."""
    figure = Figure(figsize=(11.0, 4.6), layout="constrained", dpi=110)
    axes = figure.subplots(1, 2, sharey=True)
    cells = grouped(rows, combination)
    for axis, (frame, title) in zip(axes, FRAMES.items(), strict=True):
        for shift, (ending, (words, colour)) in enumerate(ENDS.items(), start=-1):
            for column, (normalized, n_steps) in enumerate(COLUMNS):
                errors_cm = of_seeds_cm(cells[ending, frame, normalized, n_steps])
                _draw_points(axis, column + SPREAD * shift, errors_cm, colour, words if column == 0 else None)
        axis.set_xticks(range(len(COLUMNS)), list(COLUMNS.values()))
        axis.set_title(title)
        _finish(axis)
    axes[0].set_ylabel("position error [cm]")
    labels = axes[1].get_legend_handles_labels()
    figure.legend(*labels, title="end of an episode", loc="outside lower center", ncols=3, fontsize=8, title_fontsize=8)
    figure.suptitle("World without physics: last policy of each training on unseen starts, and medians")
    return figure


def ladder_figure(ladder: Sequence[tuple[str, list[Row]]]) -> Figure:
    """Draw the error of each training of the ladder."""
    figure = Figure(figsize=(10.0, 5.4), layout="constrained", dpi=110)
    axis = figure.subplots()
    for place, (_, rows) in enumerate(ladder):
        _draw_points(axis, place, of_seeds_cm(rows), "tab:blue", None)
    changes = [change.replace("`", "") for change, _ in ladder]
    labels = [changes[0], *(f"+ {change}" for change in changes[1:])]
    axis.set_xticks(range(len(ladder)), labels, rotation=35, ha="right")
    axis.set_ylabel("position error [cm]")
    axis.set_title("World without physics: one change after the other, each training and medians")
    _finish(axis)
    return figure


def of_seeds_cm(rows: Sequence[Row]) -> Floats:
    """Return the mean error of the last policy of each training, cm, (n,)."""
    return np.array([100.0 * np.mean(row["final_position_error_m"]) for row in rows])


def _draw_points(axis: Axes, place: float, errors_cm: Floats, colour: str, label: str | None) -> None:
    axis.plot(np.full(len(errors_cm), place), errors_cm, "o", color=colour, alpha=0.5, markersize=4, label=label)
    axis.plot(place, float(np.median(errors_cm)), "_", color=colour, markersize=16, markeredgewidth=2)


def _finish(axis: Axes) -> None:
    axis.axhline(TOLERANCE_CM, color="black", linestyle=":", linewidth=1)
    axis.set_yscale("log")
    plain_ticks(axis)
    axis.grid(axis="y", which="both", alpha=0.25)
