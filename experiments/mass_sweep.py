"""`python -m experiments.mass_sweep`: compares straight pushes of 1 m at 0.1 to 0.9 kg with published ones (Fig. 16).

The shipped policies and the scripted policy push from the same unseen starts, with offsets of up to 5 cm and 5 degrees.
The episodes are in `results/evaluations/mass_*.csv`, the table in `results/mass_sweep.csv`, the picture in
`results/mass_sweep.png`.
"""

import csv
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
    plain_ticks,
    read_rows,
    run_missing,
    summary_columns,
    write_table,
)

MASSES_KG: Final = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
SWEEP: Final = f"box.mass_kg={','.join(map(str, MASSES_KG))}"
FIRST_SEED: Final = 20_000
PUBLISHED: Final = Path(__file__).parent / "published" / "mass_sweep.csv"
EVALUATIONS: Final = (
    Evaluation(name="mass_variable", policy="variable", sweeps=(SWEEP,), episodes=112, first_seed=FIRST_SEED),
    Evaluation(name="mass_scripted", policy="scripted", sweeps=(SWEEP,), episodes=20, first_seed=FIRST_SEED),
    Evaluation(name="mass_fixed", policy="fixed", sweeps=(SWEEP,), episodes=20, first_seed=FIRST_SEED),
)
"""The evaluations; that of the policy that missions use has more than 1000 episodes."""
LOOKS: Final = {"variable": ("tab:blue", "o"), "fixed": ("tab:orange", "s"), "scripted": ("tab:gray", "^")}


@dataclass(frozen=True, kw_only=True)
class Config:
    """What to run."""

    again: bool = False
    """Repeat evaluations that have results, for example after a policy changed."""


def main(config: Config) -> int:
    """Run the missing evaluations, write the table and draw."""
    run_missing(EVALUATIONS, again=config.again)
    rows = [row for evaluation in EVALUATIONS for row in table(evaluation)]
    write_table(rows, RESULTS / "mass_sweep.csv")
    draw(rows, RESULTS / "mass_sweep.png")
    for row in rows:
        print(
            f"{row['policy']:9s} {row['mass_kg']} kg  {100 * row['position_error_m']:.2f} cm  "
            f"{row['angle_error_deg']:.2f} deg  success {row['success_rate']:.3f}  falls {row['falls']}  n {row['n']}"
        )
    return 0


def table(evaluation: Evaluation) -> list[dict[str, Any]]:
    """Return a row for each mass: means with 95 % intervals."""
    episodes = read_rows(evaluation.name)
    by_mass = {mass_kg: [row for row in episodes if row["box.mass_kg"] == mass_kg] for mass_kg in MASSES_KG}
    return [
        {"policy": evaluation.policy, "mass_kg": mass_kg, **summary_columns(rows)} for mass_kg, rows in by_mass.items()
    ]


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """Draw both errors over the mass; on a logarithmic scale, as the published ones are up to a hundred times as
    large."""
    with PUBLISHED.open(newline="") as file:
        published = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    panels = (
        (left, "position error [cm]", "position_error_m", "position_error_m", 100.0, 2.0),
        (right, "angle error [deg]", "angle_error_deg", "angular_error_deg", 1.0, 1.5),
    )
    for axis, label, ours, theirs, scale, limit in panels:
        mass = [row["mass_kg"] for row in published]
        axis.plot(mass, [scale * row[theirs] for row in published], "x--", color="tab:red", label="published, n 1 each")
        for policy, (color, marker) in LOOKS.items():
            here = [row for row in rows if row["policy"] == policy]
            axis.errorbar(
                [row["mass_kg"] for row in here],
                *errors_of(here, ours, scale),
                fmt=f"{marker}-",
                color=color,
                capsize=3,
                label=f"{policy}, n {here[0]['n']} each",
            )
        axis.axhline(limit, color="black", linestyle=":", linewidth=1, label="aim")
        axis.set_yscale("log")
        plain_ticks(axis)
        axis.set_xlabel("mass of the box [kg]")
        axis.set_ylabel(label)
        axis.grid(which="both", alpha=0.25)
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5, fontsize=8)
    figure.suptitle(f"Straight push of 1 m, mean with {kinds_of(rows, 'position_error_m')}")
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
