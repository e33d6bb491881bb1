"""How the trainings learn: curves, comparisons of settings, speed, and the errors at the ends.

The pictures are the counterparts of Figs. 14 and 15. Returns are a moving average over 30 episodes, and means over the
training seeds have their 95 % intervals.
"""

from collections.abc import Mapping, Sequence
from math import fsum
from typing import Final

import numpy as np

from agent_proc.statistics.intervals import mean_of_groups
from experiments.rows import Row, Rows, read_rows
from experiments.tables.parts import as_csv, as_json, made_of
from legpush.arrays import Floats

WINDOW: Final = 30
"""Episodes of the moving average, as published."""
SHARE: Final = 0.9
"""Share of the final value that defines the speed of learning."""
STUDIES: Final = (
    "training_fixed",
    "training_variable",
    "training_paper",
    "training_networks",
    "training_algorithms",
    "training_randomized",
)
Variants = dict[str, dict[int, Row]]
"""Row of each seed of each variant."""


def read_trainings() -> dict[str, Rows]:
    """Read all trainings."""
    return {name: read_rows(name) for name in STUDIES}


def variants(studies: Mapping[str, Rows]) -> Variants:
    """Return the trainings by variant and seed."""
    found: Variants = {}
    for name, study in studies.items():
        for row in study.rows:
            found.setdefault(_variant(name, row), {})[row["seed"]] = row
    return found


def _variant(study: str, row: Row) -> str:
    match study:
        case "training_paper":
            return f"paper-{row['entry']}"
        case "training_fixed" | "training_variable":
            return f"tuned-{study.removeprefix('training_')}"
        case "training_networks":
            return f"network-{len(row['hidden'])}x{row['hidden'][0]}"
        case "training_algorithms":
            return str(row["profile"])
        case _:
            return "randomized"


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = read_trainings()
    by_variant = variants(studies)
    numbers = {variant: _numbers(list(seeds.values())) for variant, seeds in by_variant.items()}
    numbers["paper"] = _numbers(studies["training_paper"].rows)
    speed = [row["episodes_to_90_percent"] for row in _speed_rows(by_variant) if row["variant"] == "tuned-fixed"]
    return {
        "learning_speed.csv": as_csv(_speed_rows(by_variant)),
        "learning_end.csv": as_csv(_end_rows(by_variant)),
        "learning.json": as_json(
            made_of(**studies), {"variants": numbers, "episodes_to_90_percent": {"tuned-fixed": sorted(speed)}}
        ),
    }


def _numbers(rows: Sequence[Row]) -> Row:
    """Return the least and the largest error of the last policies of a variant."""
    position_m = sorted(row["last_position_error_m"] for row in rows)
    angle_deg = sorted(row["last_angle_error_deg"] for row in rows)
    return {
        "n": len(rows),
        "n_evaluated": rows[0]["n_evaluated"],
        "least_success_rate": min(row["last_success_rate"] for row in rows),
        "position_errors_m": position_m,
        "least_position_error_m": position_m[0],
        "largest_position_error_m": position_m[-1],
        "least_angle_error_deg": angle_deg[0],
        "largest_angle_error_deg": angle_deg[-1],
    }


def moving_average(values: Sequence[float]) -> Floats:
    """Return the means of the last `WINDOW` values, from the first full window on, (n - WINDOW + 1,).

    The sums are exact, so that a table has the same digits on every processor.
    """
    return np.array([fsum(values[end - WINDOW : end]) / WINDOW for end in range(WINDOW, len(values) + 1)])


def _speed_rows(by_variant: Variants) -> list[Row]:
    """Return, for each training of the tuned profile, after how many episodes the average has `SHARE` of its final
    value."""
    rows = []
    for variant in ("tuned-fixed", "tuned-variable"):
        for seed, training in by_variant[variant].items():
            average = moving_average(training["episode_return"])
            reached = int(np.argmax(average >= SHARE * average[-1])) + WINDOW
            rows.append(
                {
                    "variant": variant,
                    "seed": seed,
                    "episodes": len(training["episode_return"]),
                    "first_average": round(float(average[0]), 3),
                    "final_average": round(float(average[-1]), 3),
                    "episodes_to_90_percent": reached,
                    "steps_to_90_percent": training["episode_step"][reached - 1],
                }
            )
    return rows


def _end_rows(by_variant: Variants) -> list[Row]:
    """Return, for each variant, the means over the training seeds of the means over the last `WINDOW` episodes."""
    rows = []
    for variant, seeds in by_variant.items():
        row: Row = {"variant": variant, "episodes_each": WINDOW}
        for key, n_digits in (("position_error_m", 5), ("angle_error_deg", 3)):
            ends = [training[f"episode_{key}"][-WINDOW:] for training in seeds.values()]
            row |= mean_of_groups(ends).cut(0.0).columns(key, n_digits)
        rows.append(row)
    return rows
