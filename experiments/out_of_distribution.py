"""`python -m experiments.out_of_distribution`: evaluates three policies on boxes and floors that no training has seen.

The policies are the shipped one, one that was trained with a random mass and friction in each episode, and the scripted
one. The cases are friction 0.2 to 1.0, mass up to 5 kg, an oblong, a cylinder, a wedge, an L shape, and slopes up to
5 degrees in three directions. The episodes are in `results/evaluations/ood_*.csv`, table and picture in
`results/out_of_distribution.*`.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import tyro
from matplotlib.figure import Figure

from experiments.evaluations import (
    RESULTS,
    Evaluation,
    errors_of,
    kinds_of,
    read_rows,
    run_missing,
    summary_columns,
    write_table,
)

SWEEPS: Final = (
    ("friction", ("box.friction=0.2,0.3,0.5,0.8,1.0",), False),
    ("mass", ("box.mass_kg=0.1,1,2,5",), False),
    ("oblong", ("box.size_m=0.55x0.3x0.4,0.3x0.58x0.4",), False),
    ("cylinder", ("box.shape=cylinder", "box.size_m=0.46x0.46x0.4"), True),
    ("shape", ("box.shape=wedge,l_shape",), False),
    ("slope", ("room.slope_deg=2.5,5", "room.uphill_deg=0,90,180"), True),
)
EPISODES: Final = 10
FIRST_SEED: Final = 30_000


@dataclass(frozen=True, kw_only=True)
class Config:
    """What to run."""

    randomized: str = "runs/trainings/randomized-seed1/last"
    """The policy that was trained with random masses and frictions."""
    again: bool = False
    """Repeat evaluations that have results."""


def main(config: Config) -> int:
    """Run the missing evaluations, write the table and draw."""
    policies = {"variable": "variable", "randomized": config.randomized, "scripted": "scripted"}
    evaluations = {
        (label, policy): Evaluation(
            name=f"ood_{label}_{policy}",
            policy=where,
            sweeps=sweeps,
            grid=grid,
            episodes=EPISODES,
            first_seed=FIRST_SEED,
        )
        for label, sweeps, grid in SWEEPS
        for policy, where in policies.items()
    }
    run_missing(list(evaluations.values()), again=config.again)
    rows = [row for (_, policy), evaluation in evaluations.items() for row in _table(policy, evaluation)]
    write_table(rows, RESULTS / "out_of_distribution.csv")
    _draw(rows, tuple(policies), RESULTS / "out_of_distribution.png")
    return 0


def _table(policy: str, evaluation: Evaluation) -> list[dict[str, Any]]:
    episodes = read_rows(evaluation.name)
    by_case = {case: [row for row in episodes if row["case"] == case] for case in [row["case"] for row in episodes]}
    return [{"case": case, "policy": policy, **summary_columns(rows)} for case, rows in by_case.items()]


def _draw(rows: list[dict[str, Any]], policies: tuple[str, ...], path: Path) -> None:
    """Draw both errors of every case, with a mark for each policy."""
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure = Figure(figsize=(11.0, 7.5), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    panels = (("position error [cm]", "position_error_m", 100.0), ("angle error [deg]", "angle_error_deg", 1.0))
    for axis, (label, key, scale) in zip(axes, panels, strict=True):
        for place, policy in enumerate(policies):
            here = sorted((row for row in rows if row["policy"] == policy), key=lambda row: cases.index(row["case"]))
            mean, reach = errors_of(here, key, scale)
            at = [cases.index(row["case"]) + 0.25 * (place - 1) for row in here]
            axis.errorbar(mean, at, xerr=reach, fmt="o", capsize=3, label=policy)
        axis.set_xlabel(label)
        axis.grid(alpha=0.25)
        axis.set_xlim(left=0.0)
    axes[0].set_yticks(range(len(cases)), cases)
    axes[0].invert_yaxis()
    axes[0].legend()
    kinds = kinds_of(rows, "position_error_m")
    figure.suptitle(f"Out of distribution: mean of {EPISODES} episodes each with {kinds}")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
