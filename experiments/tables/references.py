"""Boxes pushed along a sine and along a closed Dubins path, in a closed and in an open loop (Figs. 20, 21)."""

from typing import Final

from agent_proc.figures import Figure
from agent_proc.statistics.intervals import mean
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain
from legpush.scenarios.file import load_scenario
from legpush.scene.reference import reference_curve

SCENARIOS: Final = ("sine", "dubins_loop")
COMPOSITION: Final = "pushing.composition"
COLORS: Final = {"open_loop": "#c8553d", "closed_loop": "#3a6ea5"}
MEASURES: Final = ("box_path_rms_m", "box_position_error_m", "box_angle_error_deg")


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows("references")
    numbers: dict[str, dict[str, Row]] = {}
    for scenario in SCENARIOS:
        numbers[scenario] = {}
        for composition in COLORS:
            rows = study.where(**{"scenario": scenario, COMPOSITION: composition})
            numbers[scenario][composition] = {
                "n": len(rows),
                "successes": sum(row["success"] for row in rows),
                **{name: plain(mean([row[name] for row in rows]), 7) for name in MEASURES},
                **{f"worst_{name}": max(row[name] for row in rows) for name in MEASURES},
            }
    table = [{key: value for key, value in row.items() if not isinstance(value, list)} for row in study.rows]
    return {"references.csv": as_csv(table), "references.json": as_json(made_of(references=study), numbers)}


def pictures() -> dict[str, Figure]:
    """Draw the reference and the tracks of the boxes, a panel for each curve."""
    study = read_rows("references")
    figure = Figure(figsize=(11.0, 4.4), layout="constrained", dpi=120)
    for axis, name in zip(figure.subplots(1, 2, width_ratios=[1.35, 1.0]), SCENARIOS, strict=True):
        scenario = load_scenario(name)
        if scenario.reference is None:
            raise RuntimeError(f"Expected a reference in the scenario {name}")
        for composition, color in COLORS.items():
            for index, row in enumerate(study.where(**{"scenario": name, COMPOSITION: composition})):
                label = None if index else f"box, {composition.replace('_', ' ')}"
                axis.plot(row["track_box_x_m"], row["track_box_y_m"], color=color, lw=0.9, alpha=0.7, label=label)
        curve = reference_curve(scenario.reference, scenario.box.pose.pose())
        axis.plot(*curve[:, :2].T, "k--", lw=1.3, label="reference")
        axis.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title=f"scenario {name}")
    figure.legend(*axis.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
    return {"references.png": figure}
