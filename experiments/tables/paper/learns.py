"""The least change to the paper that learns, `paper-learns`, with a fixed and a variable entry (Figs. 14 and 15), and
pushing without learning from the one start of the published code.

The last policy of a training counts, on starts that nothing was chosen on.
"""

from typing import Final

import numpy as np

from experiments.rows import Row, read_rows
from experiments.tables.parts import as_json, made_of
from experiments.tables.reproduction.summaries import training_numbers

STUDIES: Final = {
    "fixed": "reproduction_learns_fixed",
    "variable": "reproduction_learns_variable_simulator",
    "variable_on_map": "reproduction_learns_variable",
}
RULES: Final = "reproduction_rules_one"
LEARNED: Final = 0.8
"""A training has learned if its last policy succeeds in this share of the starts."""


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = {name: read_rows(name) for name in (*STUDIES.values(), RULES)}
    numbers = {entry: _trainings(studies[name].rows) for entry, name in STUDIES.items()}
    rules = {
        ending: {
            row["rule"]: {"position_error_m": row["position_error_m"], "angle_error_deg": row["angle_error_deg"]}
            for row in studies[RULES].where(ending=ending)
        }
        for ending in dict.fromkeys(row["ending"] for row in studies[RULES].rows)
    }
    return {"learns.json": as_json(made_of(**studies), {**numbers, "rules": rules})}


def _trainings(rows: list[Row]) -> Row:
    """Return the numbers of trainings that differ by their seed, and those of the ones that have learned."""
    learned = [row for row in rows if np.mean(row["final_success"]) >= LEARNED]
    errors_m = [float(np.mean(row["final_position_error_m"])) for row in learned]
    return training_numbers(rows) | {
        "n_learned": len(learned),
        "least_learned_m": min(errors_m),
        "largest_learned_m": max(errors_m),
    }
