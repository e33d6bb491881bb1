"""Straight lines through the errors over the mass of the box (Fig. 16): the published errors, and ours."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy import stats

from agent_proc.statistics.estimate import Estimate
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_json, made_of, plain, published

LEAST_SQUARES: Final = "Student's t 95 % of the slope of least squares"
ERRORS: Final = {"position_m_per_kg": "position_error_m", "angle_deg_per_kg": "angle_error_deg"}
PUBLISHED: Final = {"position_m_per_kg": "position_error_m", "angle_deg_per_kg": "angular_error_deg"}


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study, theirs = read_rows("mass_sweep"), published("mass_sweep.csv")
    ours = {name: slope(*_columns(study.rows, "box.mass_kg", error)) for name, error in ERRORS.items()}
    others = {name: slope(*_columns(theirs, "mass_kg", error)) for name, error in PUBLISHED.items()}
    numbers = {
        name: {key: plain(estimate, 5) for key, estimate in slopes.items()}
        for name, slopes in (("here", ours), ("published", others))
    }
    return {"mass_trend.json": as_json(made_of(mass_sweep=study), numbers)}


def slope(masses_kg: Sequence[float], errors: Sequence[float]) -> Estimate:
    """Return the slope of the line that fits errors over masses best."""
    n = len(masses_kg)
    found = stats.linregress(masses_kg, errors)
    half = float(stats.t.ppf(0.975, n - 2) * found.stderr)
    value = float(found.slope)
    return Estimate(value=value, low=value - half, high=value + half, kind=LEAST_SQUARES, n=n)


def _columns(rows: Sequence[Row], *names: str) -> list[list[float]]:
    columns: list[list[float]] = np.array([[row[name] for name in names] for row in rows]).T.tolist()
    return columns
