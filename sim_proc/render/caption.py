"""What is written into the frames of a film: time, phase, error of the box, speed of the robot and of the film."""

from bisect import bisect_right
from math import degrees

import numpy as np

from legpush.geometry import rpy_from_quaternion, wrap_angle
from legpush.history.timeline import BOX
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.render.film import Film


def caption(film: Film, row: int, speed: float) -> tuple[tuple[str, str], ...]:
    """Return titles and values for a row of a film that is shown at this many times real time, in ASCII."""
    goal = film.scenario.goal.pose.pose()
    box = film.qpos[row, BOX]
    error_m = float(np.hypot(box[0] - goal.x_m, box[1] - goal.y_m))
    yaw_rad = float(rpy_from_quaternion(box[None, 3:])[0, 2])
    error_deg = abs(degrees(wrap_angle(yaw_rad - goal.yaw_rad)))
    after = min(row + 1, len(film.trunk_m) - 1)
    before = max(after - 2, 0)
    moved_m = float(np.hypot(*(film.trunk_m[after] - film.trunk_m[before])))
    trunk_m_s = moved_m / (max(after - before, 1) * CONTROL_PERIOD_S)
    phase = film.phases[bisect_right(film.phases, row, key=lambda each: each[0]) - 1][1]
    return (
        ("time", f"{(film.first_tick + row) * CONTROL_PERIOD_S:.1f} s"),
        ("phase", phase),
        ("box error", f"{error_m:.3f} m, {error_deg:.1f} deg"),
        ("robot", f"{trunk_m_s:.2f} m/s"),
        ("film", f"{speed:.1f} x real time"),
    )
