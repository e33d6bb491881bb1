"""What comes out of a comparison: numbers of each contestant, and differences from one of them on equal starts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from agent_proc.evaluation.loss import MOST, episode_loss
from agent_proc.statistics.aggregate import (
    Results,
    grand_mean,
    interquartile_mean,
    mean_difference,
    probability_of_improvement,
    profile,
)
from agent_proc.statistics.estimate import EQUAL, Estimate
from agent_proc.statistics.intervals import share
from agent_proc.studies.comparison.contestants import Contestant
from legpush.scene.scenario import Goal

Row = Mapping[str, Any]
Start = tuple[str, int]
"""Case and seed."""
LOSS: Final = "loss"
MEASURES: Final = ("success", "position_error_m", "angle_error_deg", LOSS, "n_cycles", "simulated_s", "decision_cpu_s")
COMPARED: Final = ("success", "position_error_m", "angle_error_deg", LOSS, "n_cycles", "simulated_s")
"""Measures with paired differences."""
THRESHOLDS: Final = tuple(np.geomspace(0.01, MOST * 0.99, 100).tolist())
"""Losses at which the profiles are computed."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """Numbers of one contestant."""

    label: str
    is_rival: bool
    n_trainings: int
    """Trainings, or 1 for a single policy."""
    n_starts: int
    means: Mapping[str, Estimate]
    """By measure, over trainings and starts."""
    loss_iqm: Estimate
    """Interquartile mean of the loss."""
    falls: int
    """Episodes in which the robot fell."""
    loss_profile: Sequence[Estimate]
    """Share of episodes with a loss of at most each of `THRESHOLDS`."""


@dataclass(frozen=True, kw_only=True)
class Versus:
    """One contestant against the one that all are compared with."""

    label: str
    differences: Mapping[str, Estimate]
    """By measure: the mean difference from the other one, on equal starts."""
    improvement: Estimate
    """Probability of the lower loss."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """A comparison."""

    against: str
    """The contestant that the others are compared with."""
    constant: tuple[float, ...]
    """Action of the best constant."""
    entries: Sequence[Entry]
    versus: Sequence[Versus]


def make_outcome(
    rows: Sequence[Row],
    contestants: Sequence[Contestant],
    against: str,
    constant: tuple[float, ...],
    fields: Sequence[str],
    goal: Goal,
) -> Outcome:
    """Summarize the rows of the study; `fields` are those that vary besides policy and start: each makes cases."""
    starts = sorted({(_case(row, fields), row["seed"]) for row in rows})
    results = {each.label: _results(rows, each, starts, fields, goal) for each in contestants}
    base = results[against]
    return Outcome(
        against=against,
        constant=constant,
        entries=[_entry(each, results[each.label], rows) for each in contestants],
        versus=[
            Versus(
                label=label,
                differences={name: mean_difference(found[name], base[name]) for name in COMPARED},
                improvement=probability_of_improvement(found[LOSS], base[LOSS]),
            )
            for label, found in results.items()
            if label != against
        ],
    )


def _case(row: Row, fields: Sequence[str]) -> str:
    return repr([row[field] for field in fields])


def _results(
    rows: Sequence[Row], contestant: Contestant, starts: Sequence[Start], fields: Sequence[str], goal: Goal
) -> dict[str, Results]:
    """Each measure of a contestant by training and start."""
    cases = list(dict.fromkeys(case for case, _ in starts))
    place = {start: index for index, start in enumerate(starts)}
    values = {name: np.full((len(contestant.policies), len(starts)), np.nan) for name in MEASURES}
    for row in rows:
        if row["policy"] in contestant.policies:
            at = contestant.policies.index(row["policy"]), place[_case(row, fields), row["seed"]]
            for name in MEASURES:
                values[name][at] = _loss(row, goal) if name == LOSS else float(row[name])
    of_start = tuple(cases.index(case) for case, _ in starts)
    return {name: Results(values=array, cases=of_start) for name, array in values.items()}


def _loss(row: Row, goal: Goal) -> float:
    return episode_loss(row["ending"] == "done", row["position_error_m"], row["angle_error_deg"], goal)


def _entry(contestant: Contestant, results: Mapping[str, Results], rows: Sequence[Row]) -> Entry:
    n_trainings, n_starts = results[LOSS].values.shape
    means = {name: grand_mean(each) for name, each in results.items()}
    success = results["success"].values
    if means["success"].kind == EQUAL:
        # Equal values are no certainty: the interval is that of one training on these starts.
        means["success"] = share(round(float(success[0].sum())), n_starts)
    return Entry(
        label=contestant.label,
        is_rival=contestant.is_rival,
        n_trainings=n_trainings,
        n_starts=n_starts,
        means=means,
        loss_iqm=interquartile_mean(results[LOSS]),
        falls=sum(row["policy"] in contestant.policies and row["ending"] == "fell" for row in rows),
        loss_profile=profile(results[LOSS], THRESHOLDS),
    )
