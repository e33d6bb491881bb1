"""Boxes of up to 40 kg: which are pushed to their goal, with the force fed forward and without."""

from collections import Counter
from typing import Final, Literal

from agent_proc.figures import Axes, Figure
from experiments.rows import Row, Rows, read_rows
from experiments.tables.parts import as_csv, as_json, made_of

FORCES: Final = ("none", "known", "felt")
TITLES: Final = {
    "none": "nothing fed forward",
    "known": "the known friction fed forward",
    "felt": "what the foot felt fed forward",
}
MAX_ROLL_DEG: Final = 2.0
"""A robot that rolls no more, and whose CoM stays over its support at every physics step, does not rock."""
Kind = Literal["reached", "rocks", "not reached"]
COLORS: Final[dict[Kind, str]] = {"reached": "#4c9f70", "rocks": "#e8c15a", "not reached": "#b8b8b8"}
REFUSED: Final = "black"
"""Colour of the frame of a cell that is refused before the robot moves."""


def _read() -> dict[str, Rows]:
    return {name: read_rows(name) for name in ("heavy_boxes", "heavy_seeds")}


def kind_of(row: Row) -> Kind:
    """Say what came of an episode."""
    if not row["within"]:
        return "not reached"
    steady = row["n_outside_support"] == 0 and row["max_abs_roll_deg"] <= MAX_ROLL_DEG
    return "reached" if steady else "rocks"


def is_refused(row: Row) -> bool:
    """Whether the bound excludes the box."""
    return bool(row["least_force_n"] > row["most_force_n"])


def _map_row(row: Row) -> Row:
    keys = ("force", "mass_kg", "friction", "foot_friction", "n_cycles", "position_error_m", "angle_error_deg")
    more = ("n_outside_support", "max_abs_roll_deg", "peak_force_n", "travel_share", "least_force_n", "most_force_n")
    return {**{key: row[key] for key in keys}, "outcome": kind_of(row), "refused": is_refused(row)} | {
        key: row[key] for key in more
    }


def _group(rows: list[Row]) -> Row:
    """Summarize episodes of one case."""
    reached = [row for row in rows if row["within"]]
    kinds = Counter(map(kind_of, rows))
    return {
        "n": len(rows),
        "within": len(reached),
        "steady": kinds["reached"],
        "least_cycles": min((row["n_cycles"] for row in reached), default=None),
        "most_cycles": max((row["n_cycles"] for row in reached), default=None),
        "worst_position_error_m": max((row["position_error_m"] for row in reached), default=None),
        "most_outside_support": max(row["n_outside_support"] for row in rows),
        "n_outside_support": sum(row["n_outside_support"] for row in rows),
        "max_abs_roll_deg": max(row["max_abs_roll_deg"] for row in rows),
        "falls": sum(row["ending"] == "fell" for row in rows),
    }


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = _read()
    cells, starts = studies["heavy_boxes"].rows, studies["heavy_seeds"].rows
    refused = [row for row in cells if is_refused(row) and row["force"] == "felt"]
    numbers = {
        "n_boxes": len(cells) // len(FORCES),
        "map": {
            force: {kind.replace(" ", "_"): count for kind, count in _counts(cells, force).items()} for force in FORCES
        },
        "refused": {
            "n": len(refused),
            "within": sum(row["within"] for row in cells if is_refused(row)),
            "least_force_n": min((row["least_force_n"] for row in refused), default=None),
            "most_force_n": max((row["most_force_n"] for row in refused), default=None),
        },
        "starts": {
            realism: {
                f"{mass_kg:g} kg": {
                    force: _group(
                        [
                            row
                            for row in starts
                            if (row["realism"], row["mass_kg"], row["force"]) == (realism, mass_kg, force)
                        ]
                    )
                    for force in FORCES
                }
                for mass_kg in sorted({row["mass_kg"] for row in starts})
            }
            for realism in ("ideal", "real")
        },
    }
    return {
        "heavy_boxes.csv": as_csv([_map_row(row) for row in cells]),
        "heavy_boxes.json": as_json(made_of(**studies), numbers),
    }


def _counts(cells: list[Row], force: str) -> dict[Kind, int]:
    kinds = Counter(kind_of(row) for row in cells if row["force"] == force)
    return {kind: kinds[kind] for kind in COLORS}


def pictures() -> dict[str, Figure]:
    """Draw the map: a panel for each way to feed forward and each friction of the feet."""
    rows = _read()["heavy_boxes"].rows
    feet = sorted({row["foot_friction"] for row in rows}, reverse=True)
    figure = Figure(figsize=(11.0, 7.0), layout="constrained", dpi=110)
    panels = figure.subplots(len(feet), len(FORCES), sharex=True, sharey=True)
    for line, foot_friction in zip(panels, feet, strict=True):
        for axis, force in zip(line, FORCES, strict=True):
            here = [row for row in rows if (row["force"], row["foot_friction"]) == (force, foot_friction)]
            _panel(axis, here)
            axis.set_title(f"{TITLES[force]}\nfriction of the feet {foot_friction:g}", fontsize=9)
    for axis in panels[-1]:
        axis.set_xlabel("mass of the box [kg]")
    for line in panels:
        line[0].set_ylabel("friction of box and floor")
    for kind, color in COLORS.items():
        panels[0][0].bar([-9], [0], color=color, label=kind)
    panels[0][0].bar([-9], [0], facecolor="none", edgecolor=REFUSED, label="refused before it moves")
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    figure.suptitle("Pushing a box 1 m ahead: number of push cycles (one episode for each cell)")
    return {"heavy_boxes.png": figure}


def _panel(axis: Axes, rows: list[Row]) -> None:
    masses, frictions = (sorted({row[key] for row in rows}) for key in ("mass_kg", "friction"))
    for row in rows:
        x, y = masses.index(row["mass_kg"]), frictions.index(row["friction"])
        kind, edge = kind_of(row), REFUSED if is_refused(row) else "white"
        axis.bar([x], [0.9], bottom=[y - 0.45], width=0.9, color=COLORS[kind], edgecolor=edge, linewidth=1.5)
        if row["within"]:
            axis.text(x, y, str(row["n_cycles"]), ha="center", va="center", fontsize=8)
    axis.set_xticks(range(len(masses)), [f"{mass:g}" for mass in masses])
    axis.set_yticks(range(len(frictions)), [f"{friction:g}" for friction in frictions])
    axis.set_xlim(-0.6, len(masses) - 0.4)
    axis.set_ylim(-0.6, len(frictions) - 0.4)
