"""The rate of turn of circular pushing (Eq. 21): per second, per push cycle, per step of the physics.

The published series say how long a push cycle took there: the box stands still between two pushes, so the size of its
moves from sample to sample has the period of the push cycle. The period is that of the largest peak of a periodogram in
each window of the series; the median of the windows is reported.
"""

from typing import Any, Final

import numpy as np

from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import median
from experiments.cells.circle import fit_sine
from experiments.rows import Row, Rows, read_rows
from experiments.tables.circles import FRICTION, PUBLISHED_FITS
from experiments.tables.parts import as_csv, as_json, made_of, plain, published
from legpush.arrays import Floats
from legpush.geometry import wrap_angle

WINDOW_S: Final = 3000.0
PERIODS_S: Final = np.arange(60.0, 180.0, 0.1)
"""Possible durations of a push cycle: more than two samples of the series, and than the 38 s that the published code
waits in each cycle."""
PUBLISHED_STEP_S: Final = 0.05
"""The default time step of CoppeliaSim, which the paper used."""
OUR_STEP_S: Final = 0.002
DEPTHS_M: Final = (0.03, 0.05, 0.08)
USUAL: Final = "5 cm"
SHALLOW: Final = "3 cm"


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows("circles")
    theirs = {direction: _published_rates(direction) for direction in PUBLISHED_FITS}
    ours = {f"{100 * depth_m:g} cm": _our_rates(study, depth_m) for depth_m in DEPTHS_M}
    units = list(ours[USUAL])
    table = [{"series": f"published, {name}", **_flat(rates, units)} for name, rates in theirs.items()]
    table += [{"series": f"here, depth {name}", **_flat(rates, units)} for name, rates in ours.items()]
    numbers = {
        "published": theirs,
        "here": ours,
        "here_over_published": {direction: _over(ours[USUAL], rates) for direction, rates in theirs.items()},
        "shallow_over_published": {direction: _over(ours[SHALLOW], rates) for direction, rates in theirs.items()},
    }
    return {"turn_rate.csv": as_csv(table), "turn_rate.json": as_json(made_of(circles=study), numbers)}


def _published_rates(direction: str) -> Row:
    series = np.array([list(row.values()) for row in published(f"circle_{direction}.csv")])
    _, omega_rad_s, _, _, begin_s, _ = PUBLISHED_FITS[direction]
    steady = series[series[:, 0] >= begin_s]
    fit = fit_sine(steady[:, 0], steady[:, 1], omega_rad_s)
    cycle_s = cycle_time_s(steady)
    rates = _rates(fit["omega_rad_s"], cycle_s, fit["amplitude_m"], PUBLISHED_STEP_S)
    return rates | {"phi_rad": wrap_angle(fit["phi_rad"])}


def _our_rates(study: Rows, depth_m: float) -> Row:
    rows = study.where(depth_m=depth_m, friction=FRICTION)
    cycle_s = float(np.mean([np.diff(row["cycle_time_s"]).mean() for row in rows]))
    omega, radius = (float(np.mean([row[name] for row in rows])) for name in ("omega_rad_s", "radius_m"))
    return _rates(omega, cycle_s, radius, OUR_STEP_S)


def _rates(omega_rad_s: float, cycle_s: float | Estimate, radius_m: float, step_s: float) -> Row:
    """Return a rate of turn in all units."""
    middle_s = cycle_s.value if isinstance(cycle_s, Estimate) else cycle_s
    return {
        "millirad_s": 1e3 * omega_rad_s,
        "cycle_s": plain(cycle_s, 1) if isinstance(cycle_s, Estimate) else cycle_s,
        "turn_deg_per_cycle": float(np.degrees(omega_rad_s * middle_s)),
        "microrad_per_step": 1e6 * omega_rad_s * step_s,
        "turn_s": 2 * np.pi / omega_rad_s,
        "radius_m": radius_m,
        "way_m_per_cycle": omega_rad_s * middle_s * radius_m,
    }


def cycle_time_s(series: Floats) -> Estimate:
    """Return the duration of a push cycle in a series of times and places, (n, 2): the median over windows."""
    time_s, moved_m = (series[1:, 0] + series[:-1, 0]) / 2, np.abs(np.diff(series[:, 1]))
    begins_s = np.arange(time_s[0], time_s[-1] - WINDOW_S, WINDOW_S)
    windows = [(time_s >= begin_s) & (time_s < begin_s + WINDOW_S) for begin_s in begins_s]
    return median([_period_s(time_s[window], moved_m[window]) for window in windows])


def _period_s(time_s: Floats, value: Floats) -> float:
    """Return the period of the largest peak of a periodogram of values at times, (n,) each."""
    weighted = (value - value.mean()) * np.hanning(len(value))
    power = np.abs(np.exp(-2j * np.pi * time_s / PERIODS_S[:, None]) @ weighted)
    return float(PERIODS_S[power.argmax()])


def _over(ours: Row, theirs: Row) -> Row:
    return {name: _value(ours[name]) / _value(theirs[name]) for name in ours}


def _value(number: Any) -> float:
    return float(number["value"] if isinstance(number, dict) else number)


def _flat(rates: Row, units: list[str]) -> Row:
    return {name: float(f"{_value(rates[name]):.5g}") for name in units}
