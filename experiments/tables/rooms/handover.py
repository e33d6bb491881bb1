"""Missions in the same random rooms with different distances at which the robot hands over to pushing.

The paper leaves open at which distance the robot should stop following the map and use the measured box instead.
"""

from typing import Final

import numpy as np

from agent_proc.figures import Figure
from agent_proc.statistics.estimate import Estimate, kinds_in_words
from agent_proc.statistics.intervals import mean
from agent_proc.statistics.paired import paired_difference
from experiments.rows import Row, Rows, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain
from experiments.tables.rooms.by_seed import of_successes
from legpush.scene.scenario import MissionSettings

AXIS: Final = "mission.handover_distance_m"
MEASURES: Final = (
    ("box_position_error_m", "box position error [cm]", 100.0),
    ("box_angle_error_deg", "box angle error [deg]", 1.0),
    ("robot_travel_m", "way of the robot [m]", 1.0),
    ("sim_time_s", "simulated time [s]", 1.0),
)
USUAL_M: Final = MissionSettings().handover_distance_m
BLUE: Final = "#3a6ea5"


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows("handover")
    here = _by_distance(study)
    differences = [_differences(distance_m, here) for distance_m in here if distance_m != USUAL_M]
    means_m = [_mean(rows, "box_position_error_m").value for rows in here.values()]
    means_deg = [_mean(rows, "box_angle_error_deg").value for rows in here.values()]
    numbers = {
        "n": len(study.rows),
        "n_rooms": len(here[USUAL_M]),
        "successes": sum(row["success"] for row in study.rows),
        "least_position_error_m": min(means_m),
        "largest_position_error_m": max(means_m),
        "least_angle_error_deg": min(means_deg),
        "largest_angle_error_deg": max(means_deg),
        "minus_usual": {
            f"{distance_m:g} m": {name: plain(_difference(distance_m, here, name), 7) for name, _, _ in MEASURES}
            for distance_m in here
            if distance_m != USUAL_M
        },
        "largest_difference": {
            name: max(
                (plain(_difference(distance_m, here, name), 7) for distance_m in here if distance_m != USUAL_M),
                key=lambda one: abs(one["value"]),
            )
            for name, _, _ in MEASURES
        },
    }
    table = [{key: value for key, value in row.items() if not isinstance(value, list)} for row in study.rows]
    return {
        "handover.csv": as_csv([{k: v for k, v in row.items() if k != "drawn_scenario"} for row in table]),
        "handover_differences.csv": as_csv(differences),
        "handover.json": as_json(made_of(handover=study), numbers),
    }


def _by_distance(study: Rows) -> dict[float, list[Row]]:
    return {distance_m: study.where(**{AXIS: distance_m}) for distance_m in sorted({row[AXIS] for row in study.rows})}


def _differences(distance_m: float, here: dict[float, list[Row]]) -> Row:
    """Return by how much each measure differs from that at the usual distance, in the same rooms."""
    row: Row = {"handover_m": distance_m, "minus_that_at_m": USUAL_M}
    for name, _, _ in MEASURES:
        row |= _difference(distance_m, here, name).columns(name, 5)
    return row


def _difference(distance_m: float, here: dict[float, list[Row]], name: str) -> Estimate:
    return paired_difference(of_successes(here[distance_m], name), of_successes(here[USUAL_M], name))


def _mean(rows: list[Row], name: str) -> Estimate:
    return mean(list(of_successes(rows, name).values()))


def pictures() -> dict[str, Figure]:
    """Draw each measure over the distance: missions as dots, means with intervals."""
    here = _by_distance(read_rows("handover"))
    figure = Figure(figsize=(10.0, 5.6), layout="constrained", dpi=110)
    kinds: list[str] = []
    for axis, (name, label, scale) in zip(figure.subplots(2, 2).ravel(), MEASURES, strict=True):
        jitter = np.random.default_rng(0)
        for distance_m, rows in here.items():
            values = [scale * value for value in of_successes(rows, name).values()]
            at = distance_m + jitter.uniform(-0.1, 0.1, len(values))
            axis.plot(at, values, "o", ms=3, color=BLUE, alpha=0.3, mew=0)
        means = [_mean(rows, name).scaled(scale) for rows in here.values()]
        kinds += [one.kind for one in means]
        middle, ends = np.array([one.value for one in means]), np.array([one.ends for one in means]).T
        axis.errorbar(list(here), middle, np.abs(ends - middle), fmt="o-", color=BLUE, capsize=3, ms=4)
        axis.set(xlabel="distance to the box at hand-over, at most [m]", ylabel=label)
        axis.set_ylim(bottom=0.0)
    n = len(next(iter(here.values())))
    figure.suptitle(f"Hand-over distance, the same {n} random rooms: missions, and means with {kinds_in_words(kinds)}")
    return {"handover.png": figure}
