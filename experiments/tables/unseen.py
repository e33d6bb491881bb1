"""Boxes and floors that no training has seen: dynamic programming, learned policies, the scripted and blind ones."""

from typing import Any, Final

from agent_proc.figures import Figure
from experiments.rows import Row, Rows, read_rows
from experiments.tables.parts import as_csv, as_json, errors_of, kinds_of, made_of, summary_columns

AXES: Final[dict[str, Any]] = {
    "box.friction": 0.5,
    "box.mass_kg": 0.1,
    "box.size_m": [0.4, 0.5, 0.4],
    "box.shape": "cuboid",
    "room.slope_deg": 0.0,
    "room.uphill_deg": 0.0,
}
"""Varied fields with the values of the box and floor of the trainings."""
SEEING: Final = ("dynamic_programming", "variable", "randomized", "scripted")
BLIND: Final = ("constant", "alternate", "random")
POLICIES: Final = (*SEEING, *BLIND)
LONG_BOX: Final = "box.size_m=0.55x0.3x0.4"


def _read() -> dict[str, Rows]:
    return {name: read_rows(name) for name in ("unseen", "unseen_randomized", "unseen_blind")}


def case_of(row: Row) -> str:
    """Name a case by what differs from the trainings, such as `box.friction=0.2`."""
    changed = [f"{name}={_word(row[name])}" for name, usual in AXES.items() if row[name] != usual]
    return " ".join(changed) or "as trained"


def _word(value: Any) -> str:
    return "x".join(map(str, value)) if isinstance(value, list) else str(value)


def _table(studies: dict[str, Rows]) -> list[Row]:
    """Return a row for each policy and case."""
    groups: dict[tuple[str, str], list[Row]] = {}
    for name, study in studies.items():
        for row in study.rows:
            policy = "randomized" if name == "unseen_randomized" else row["policy"]
            groups.setdefault((policy, case_of(row)), []).append(row)
    order = sorted(groups, key=lambda key: POLICIES.index(key[0]))
    return [{"case": case, "policy": policy, **summary_columns(groups[policy, case])} for policy, case in order]


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = _read()
    table = _table(studies)
    cases: dict[str, dict[str, Row]] = {policy: {} for policy in POLICIES}
    for row in table:
        cases[row["policy"]][row["case"]] = {
            key: row[key] for key in ("n", "successes", "position_error_m", "angle_error_deg")
        }
    numbers = {"ordinary": {policy: _ordinary(of_policy) for policy, of_policy in cases.items()}, "cases": cases}
    return {"unseen.csv": as_csv(table), "unseen.json": as_json(made_of(**studies), numbers)}


def _ordinary(cases: dict[str, Row]) -> Row:
    """Return the sums over the cases on a level floor, without the long box, and the largest means."""
    rows = [row for case, row in cases.items() if not case.startswith("room.") and case != LONG_BOX]
    return {
        "n_cases": len(rows),
        "n": sum(row["n"] for row in rows),
        "successes": sum(row["successes"] for row in rows),
        "largest_position_error_m": max(row["position_error_m"] for row in rows),
        "largest_angle_error_deg": max(row["angle_error_deg"] for row in rows),
    }


def pictures() -> dict[str, Figure]:
    """Draw both errors of every case, with a mark for each policy that looks at the box."""
    rows = [row for row in _table(_read()) if row["policy"] in SEEING]
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure = Figure(figsize=(11.0, 7.5), layout="constrained", dpi=110)
    axes = figure.subplots(1, 2, sharey=True)
    panels = (("position error [cm]", "position_error_m", 100.0), ("angle error [deg]", "angle_error_deg", 1.0))
    for axis, (label, key, scale) in zip(axes, panels, strict=True):
        shown = [policy for policy in SEEING if any(row["policy"] == policy for row in rows)]
        for place, policy in enumerate(shown):
            here = [row for row in rows if row["policy"] == policy]
            middle, reach = errors_of(here, key, scale)
            at = [cases.index(row["case"]) + 0.2 * (place - 0.5 * (len(shown) - 1)) for row in here]
            axis.errorbar(middle, at, xerr=reach, fmt="o", capsize=3, label=policy)
        axis.set_xlabel(label)
        axis.grid(alpha=0.25)
        axis.set_xlim(left=0.0)
    axes[0].set_yticks(range(len(cases)), cases)
    axes[0].invert_yaxis()
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(shown))
    kinds = kinds_of(rows, "position_error_m")
    figure.suptitle(f"Unseen boxes and floors: mean of {rows[0]['n']} episodes each with {kinds}")
    return {"unseen.png": figure}
