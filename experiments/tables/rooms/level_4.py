"""Level 4 of the benchmark: whole missions in random rooms by several policies, room by room."""

from typing import Any, Final

import numpy as np

from agent_proc.statistics.intervals import mean, share
from agent_proc.statistics.paired import paired_difference
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_csv, as_json, made_of, plain
from experiments.tables.rooms.by_seed import failures, of_successes

STUDY: Final = "level_l4"
LEARNED: Final = "variable"
MEASURES: Final = ("sim_time_s", "n_push_cycles", "box_position_error_m", "box_angle_error_deg")
COLUMNS: Final = ("policy", "seed", "success", "reason", *MEASURES, "state_crc")
N_DIGITS: Final = 7


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows(STUDY)
    return {
        "level_4.csv": as_csv([{column: row[column] for column in COLUMNS} for row in study.rows]),
        "level_4.json": as_json(made_of(**{STUDY: study}), numbers_of(study.rows)),
    }


def numbers_of(rows: list[Row]) -> dict[str, Any]:
    """Return the numbers of each policy, and those less the best one that did not learn.

    The best one succeeds most often, and of equal ones in the least time.
    """
    policies = dict.fromkeys(row["policy"] for row in rows)
    by_policy = {policy: [row for row in rows if row["policy"] == policy] for policy in policies}
    numbers = {policy: _numbers(own) for policy, own in by_policy.items()}
    unlearned = [policy for policy in policies if policy != LEARNED]
    best = min(unlearned, key=lambda policy: (-numbers[policy]["successes"], numbers[policy]["median_time_s"]))
    return {
        "n": len({row["seed"] for row in rows}),
        "best_rival": best,
        "policies": numbers,
        "minus_best_rival": {
            policy: _less(own, by_policy[best]) for policy, own in by_policy.items() if policy != best
        },
    }


def _numbers(rows: list[Row]) -> dict[str, Any]:
    n_successes = sum(row["success"] for row in rows)
    return {
        "n": len(rows),
        "successes": n_successes,
        "success": plain(share(n_successes, len(rows)), N_DIGITS),
        "failures": failures(rows),
        "median_time_s": float(np.median([row["sim_time_s"] for row in rows])),
        **{name: plain(mean(list(of_successes(rows, name).values())), N_DIGITS) for name in MEASURES if n_successes},
    }


def _less(rows: list[Row], best: list[Row]) -> dict[str, Any]:
    """Differences: of the share of successes in all rooms, of measures in the rooms in which both succeed."""
    success = paired_difference(*({row["seed"]: float(row["success"]) for row in some} for some in (rows, best)))
    both = of_successes(rows, "sim_time_s").keys() & of_successes(best, "sim_time_s").keys()
    return {
        "success": plain(success, N_DIGITS),
        "n_both": len(both),
        **{
            name: plain(paired_difference(of_successes(rows, name), of_successes(best, name)), N_DIGITS)
            for name in MEASURES
            if both
        },
    }
