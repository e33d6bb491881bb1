"""Summaries of trainings, over their seeds, and of episodes without learning, over their starts.

The last policy of a training counts, on starts that nothing was chosen on.
"""

from collections.abc import Callable, Sequence
from math import inf
from typing import Any, Final

import numpy as np

from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import mean, mean_of_groups, share
from experiments.rows import Row
from experiments.tables.learning import WINDOW, moving_average
from experiments.tables.parts import plain

DIGITS: Final = {"success": 4, "position_error_m": 5, "angle_error_deg": 3, "n_cycles": 1}
"""Measures of an episode, and the digits that are kept of their means."""
MOST: Final = {"success": 1.0}


def training_estimates(rows: Sequence[Row]) -> dict[str, Estimate]:
    """Return the mean over training seeds of each measure of the last policies."""
    means = {
        name: mean_of_groups([[float(value) for value in row[f"final_{name}"]] for row in rows]) for name in DIGITS
    }
    return {name: estimate.cut(0.0, MOST.get(name, inf)) for name, estimate in means.items()}


def training_columns(rows: Sequence[Row]) -> Row:
    """Return the columns of trainings that differ by their seed alone."""
    columns: Row = {"n_seeds": len(rows), "n_starts": len(rows[0]["final_success"])}
    for name, estimate in training_estimates(rows).items():
        columns |= estimate.columns(name, DIGITS[name])
    return columns


def training_numbers(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the numbers of trainings that differ by their seed alone, for pages."""
    errors_m = np.array([row["final_position_error_m"] for row in rows])
    of_seeds_m = errors_m.mean(axis=1)
    shares = [float(np.mean(row["final_success"])) for row in rows]
    return {
        "n_seeds": len(rows),
        "n_starts": errors_m.shape[1],
        **{name: plain(estimate, DIGITS[name]) for name, estimate in training_estimates(rows).items()},
        "least_position_error_m": round(float(of_seeds_m.min()), 5),
        "largest_position_error_m": round(float(of_seeds_m.max()), 5),
        "least_success": round(min(shares), 4),
        "largest_success": round(max(shares), 4),
        "nominal_position_error_m": plain(mean([row["nominal_position_error_m"] for row in rows]).cut(0.0), 5),
        "nominal_angle_error_deg": plain(mean([row["nominal_angle_error_deg"] for row in rows]).cut(0.0), 3),
        "own_end_position_error_m": plain(mean([row["last_position_error_m"] for row in rows]).cut(0.0), 5),
        "own_end_success": plain(mean([row["last_success_rate"] for row in rows]).cut(0.0, 1.0), 4),
        "least_own_end_success": round(min(row["last_success_rate"] for row in rows), 4),
        "largest_own_end_success": round(max(row["last_success_rate"] for row in rows), 4),
        "n_own_end": rows[0]["n_evaluated"],
        "n_episodes": [len(row["episode_return"]) for row in rows],
        **_returns(rows),
    }


def _returns(rows: Sequence[Row]) -> dict[str, Any]:
    """Return where the average return of each training begins and ends."""
    averages = [moving_average(row["episode_return"]) for row in rows if len(row["episode_return"]) >= WINDOW]
    return {
        "first_average_return": [round(float(average[0]), 1) for average in averages],
        "final_average_return": [round(float(average[-1]), 1) for average in averages],
    }


def rule_estimates(rows: Sequence[Row]) -> dict[str, Estimate]:
    """Return the mean over starts of each measure."""
    found: dict[str, Estimate] = {"success": share(sum(row["success"] for row in rows), len(rows))}
    return found | {name: mean([float(row[name]) for row in rows]).cut(0.0) for name in DIGITS if name != "success"}


def rule_columns(rows: Sequence[Row]) -> Row:
    """Return the columns of episodes that differ by their start alone."""
    columns: Row = {"n_seeds": "", "n_starts": len(rows)}
    for name, estimate in rule_estimates(rows).items():
        columns |= estimate.columns(name, DIGITS[name])
    return columns


def rule_numbers(rows: Sequence[Row]) -> dict[str, Any]:
    """Return the numbers of episodes that differ by their start alone, for pages."""
    return {"n": len(rows), **{name: plain(each, DIGITS[name]) for name, each in rule_estimates(rows).items()}}


def grouped(rows: Sequence[Row], key: Callable[[Row], tuple[Any, ...]]) -> dict[tuple[Any, ...], list[Row]]:
    """Return the rows by their key, in the order in which keys appear."""
    found: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return found
