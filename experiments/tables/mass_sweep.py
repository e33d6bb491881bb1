"""Straight pushes of 1 m at 0.1 to 0.9 kg, beside the published ones (Fig. 16)."""

from typing import Final

from agent_proc.figures import Figure
from experiments.rows import Row, Rows, has_rows, read_rows
from experiments.tables.parts import (
    as_csv,
    as_json,
    errors_of,
    kinds_of,
    made_of,
    plain_ticks,
    published,
    summary_columns,
)

LOOKS: Final = {
    "variable": ("tab:blue", "o"),
    "dynamic_programming": ("tab:green", "D"),
    "fixed": ("tab:orange", "s"),
    "scripted": ("tab:gray", "^"),
    "constant": ("black", "v"),
}
"""Colour and mark of the policies in the picture."""
POLICIES: Final = (*LOOKS, "alternate", "random")


def _read() -> dict[str, Rows]:
    return {name: read_rows(name) for name in ("mass_sweep", "mass_sweep_others", "mass_sweep_blind") if has_rows(name)}


def _table(studies: dict[str, Rows]) -> list[Row]:
    """Return a row for each policy and mass."""
    rows = [row for study in studies.values() for row in study.rows]
    groups: dict[tuple[str, float], list[Row]] = {}
    for row in rows:
        groups.setdefault((row["policy"], row["box.mass_kg"]), []).append(row)
    return [
        {"policy": policy, "mass_kg": mass_kg, **summary_columns(groups[policy, mass_kg])} for policy, mass_kg in groups
    ]


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = _read()
    ours = studies["mass_sweep"].rows
    margins_m = [row["min_support_margin_m"] for row in ours]
    table = _table(studies)
    numbers = {
        "n": len(ours),
        "successes": sum(row["success"] for row in ours),
        "falls": sum(row["ending"] == "fell" for row in ours),
        "worst_position_error_m": max(row["position_error_m"] for row in ours),
        "worst_angle_error_deg": max(row["angle_error_deg"] for row in ours),
        "max_abs_pitch_deg": max(row["max_abs_pitch_deg"] for row in ours),
        "max_abs_roll_deg": max(row["max_abs_roll_deg"] for row in ours),
        "min_support_margin_m": min(margins_m),
        "n_with_positive_margin": sum(margin_m > 0.0 for margin_m in margins_m),
        "policies": {
            policy: {f"{row['mass_kg']:g} kg": _errors(row) for row in table if row["policy"] == policy}
            for policy in POLICIES
            if any(row["policy"] == policy for row in table)
        },
    }
    return {"mass_sweep.csv": as_csv(table), "mass_sweep.json": as_json(made_of(**studies), numbers)}


def _errors(row: Row) -> Row:
    """Return the errors of a row as estimates."""
    names = {"position_error_m": "position", "angle_error_deg": "angle"}
    ends = {"value": "", "low": "_low", "high": "_high", "kind": "_interval"}
    found: Row = {short: {name: row[f"{key}{end}"] for name, end in ends.items()} for key, short in names.items()}
    return found | {"n": row["n"], "successes": row["successes"]}


def pictures() -> dict[str, Figure]:
    """Draw both errors over the mass; on a logarithmic scale, as the published ones are up to a hundred times as
    large."""
    rows, theirs = _table(_read()), published("mass_sweep.csv")
    figure = Figure(figsize=(9.0, 4.2), layout="constrained", dpi=120)
    left, right = figure.subplots(1, 2)
    panels = (
        (left, "position error [cm]", "position_error_m", "position_error_m", 100.0, 2.0),
        (right, "angle error [deg]", "angle_error_deg", "angular_error_deg", 1.0, 1.5),
    )
    for axis, label, ours, other, scale, limit in panels:
        mass = [row["mass_kg"] for row in theirs]
        axis.plot(mass, [scale * row[other] for row in theirs], "x--", color="tab:red", label="published, n 1 each")
        for policy, (color, marker) in LOOKS.items():
            here = [row for row in rows if row["policy"] == policy]
            if not here:
                continue
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
    return {"mass_sweep.png": figure}
