"""How firmly the robot stands in missions (Table 1, 3.1.4, Eq. 9), and where pushing begins (Fig. 5)."""

from typing import Final

import numpy as np

from agent_proc.statistics.intervals import mean
from experiments.rows import Row, read_rows
from experiments.tables.parts import as_json, made_of, plain
from legpush.scene.robot import RobotSpec
from sim_proc.gravity import GRAVITY_M_S2

PHASES: Final = ("walk", "push")
HAND_OVER_M: Final = 3.0
N_DIGITS: Final = 5


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    missions, straight, close_up = (read_rows(name) for name in ("missions", "straight_push", "close_up"))
    rows = missions.rows
    moments = [row["push_max_push_moment_n_m"] for row in rows]
    distances = [row["handover_distance_m"] for row in rows if row["walk_n_steps"]]
    weight_n = RobotSpec().mass_kg * GRAVITY_M_S2
    numbers = {
        "n": len(rows),
        "to_joint_limit_deg": {phase: least(rows, f"{phase}_least_to_joint_limit_deg") for phase in PHASES},
        "push_moment_n_m": plain(mean(moments), N_DIGITS),
        "largest_push_moment_n_m": max(moments),
        "largest_push_moment_over_weight_m": max(moments) / weight_n,
        "one_push": {f"{row['mass_kg']:g} kg": _pressed(row, weight_n) for row in close_up.rows},
        "tilt_deg": {
            "pitch": max(row["trunk_max_abs_pitch_deg"] for row in rows),
            "roll": max(row["trunk_max_abs_roll_deg"] for row in rows),
        },
        "margins_m": {
            name: {phase: least(rows, f"{phase}_min_{name}_margin_m") for phase in PHASES}
            for name in ("support", "zmp", "capture")
        },
        "straight_push": {
            "n": len(straight.rows),
            **{
                name: float(max(np.abs(row[f"{name}_deg"]).max() for row in straight.rows))
                for name in ("roll", "pitch")
            },
        },
        "handover_m": {"n": len(distances), "least": min(distances), "largest": max(distances)},
    }
    return {"stability.json": as_json(made_of(missions=missions, straight_push=straight, close_up=close_up), numbers)}


def least(rows: list[Row], name: str) -> float:
    """Return the least value of a measure of the missions that have it."""
    return float(min(row[name] for row in rows if row[name] is not None))


def _pressed(row: Row, weight_n: float) -> Row:
    """Return the force of the box and the sum of Eq. 9 in the tick of a push in which the box presses the most."""
    moment_n_m = float(np.hypot(*row["press_moment_n_m"][:2]))
    return {
        "force_n": row["force_n"][row["press_tick"]],
        "moment_n_m": moment_n_m,
        "moment_over_weight_m": moment_n_m / weight_n,
    }
