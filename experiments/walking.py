"""`python experiments/walking.py`: measures speed, steadiness and accuracy of the crawl on simple paths.

One simulator in this process walks each path once, since everything is deterministic. Speed is the length of the path
over the time from rest to rest; the cruising speed is that of the middle half of the path. The table goes to
`results/walking.csv`.
"""

import csv
from collections.abc import Sequence
from math import cos, degrees, pi, sin
from pathlib import Path
from typing import Any, Final

import numpy as np
from msgspec.structs import replace

from legpush.geometry import Pose2, rpy_from_quaternion, wrap_angle
from legpush.messages.stepping import Follow, PathProgress, Reset, Trace, Walk
from legpush.scenarios.file import load_scenario
from legpush.scene.robot import CONTROL_PERIOD_S
from legpush.scene.scenario import Room, Scenario
from sim_proc.simulator import Simulator

TABLE: Final = Path(__file__).parent / "results" / "walking.csv"
STEP_M: Final = 0.05


def paths() -> dict[str, list[Pose2]]:
    """Return the paths by name; they begin at (10, 10) and head along x."""
    return {
        "straight, 6 m": _arc(6.0, 0.0),
        "circle of radius 2 m": _arc(4 * pi, 1 / 2.0),
        "circle of radius 0.8 m": _arc(1.6 * pi, 1 / 0.8),
        "S of radius 1 m": [*_arc(pi / 2, 1.0), *_arc(pi / 2, -1.0, _arc(pi / 2, 1.0)[-1])],
        "turn on the spot by 180 degrees": [_pose(10.0, 10.0, yaw) for yaw in np.linspace(0.0, pi, 40)],
    }


def main() -> None:
    """Walk all paths and write the table."""
    rows = [measure(name, path) for name, path in paths().items()]
    TABLE.parent.mkdir(exist_ok=True)
    with TABLE.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(TABLE.read_text(), end="")


def measure(name: str, path: Sequence[Pose2]) -> dict[str, Any]:
    """Walk one path; return its row of the table."""
    simulator = Simulator()
    simulator.perform(Reset(scenario=_scenario(), seed=0), with_trace=False)
    simulator.perform(Follow(waypoints=tuple(path)), with_trace=False)
    traces: list[Trace] = []
    progress: list[tuple[float, PathProgress]] = []
    while not progress or not progress[-1][1].done:
        outcome = simulator.perform(Walk(), with_trace=True)
        if outcome.world.path is None or outcome.trace is None or outcome.world.fallen:
            raise RuntimeError(f"{name}: the walk ended early")
        traces.append(outcome.trace)
        progress.append((outcome.world.tick * CONTROL_PERIOD_S, outcome.world.path))
    trunk = np.concatenate([np.array(trace.qpos)[:, :2] for trace in traces])
    points = np.array([[pose.x_m, pose.y_m] for pose in path])
    off = np.array([np.linalg.norm(points - here, axis=1).min() for here in trunk])
    length_m = progress[-1][1].length_m
    middle = [(s, p.travelled_m) for s, p in progress if 0.25 * length_m <= p.travelled_m <= 0.75 * length_m]
    (t0, s0), (t1, s1) = middle[0], middle[-1]
    last = outcome.world.trunk
    end_yaw_rad = float(rpy_from_quaternion(last.orientation_wxyz)[2])
    tilt = np.abs(np.concatenate([trace.roll_pitch_rad for trace in traces])).max()
    return {
        "path": name,
        "length_m": round(length_m, 3),
        "time_s": round(progress[-1][0], 2),
        "speed_m_s": round(length_m / progress[-1][0], 3),
        "cruising_speed_m_s": round((s1 - s0) / (t1 - t0), 3),
        "tracking_rms_m": round(float(np.sqrt((off**2).mean())), 4),
        "end_error_m": round(float(np.hypot(last.position_m[0] - path[-1].x_m, last.position_m[1] - path[-1].y_m)), 4),
        "end_yaw_error_deg": round(abs(degrees(wrap_angle(end_yaw_rad - path[-1].yaw_rad))), 2),
        "trunk_max_abs_tilt_deg": round(degrees(tilt), 2),
        "min_support_margin_m": round(min(min(trace.support_margin_m) for trace in traces), 4),
    }


def _scenario() -> Scenario:
    """Return an empty floor, with the box out of the way."""
    base = load_scenario("push")
    start = replace(base.start, x_m=10.0, y_m=10.0, yaw_deg=0.0)
    box = replace(base.box, pose=replace(base.box.pose, x_m=2.0, y_m=2.0))
    room = Room(size_m=(20.0, 20.0))
    return replace(base, room=room, start=start, box=box, randomization=type(base.randomization)())


def _arc(length_m: float, curvature_per_m: float, begin: Pose2 | None = None) -> list[Pose2]:
    """Return poses along an arc; a positive curvature turns left."""
    begin = _pose(10.0, 10.0, 0.0) if begin is None else begin
    poses = []
    for s in np.linspace(0.0, length_m, round(length_m / STEP_M) + 1):
        turn = s * curvature_per_m
        if curvature_per_m == 0.0:
            ahead = _pose(s, 0.0, 0.0)
        else:
            ahead = _pose(sin(turn) / curvature_per_m, (1 - cos(turn)) / curvature_per_m, turn)
        poses.append(begin @ ahead)
    return poses


def _pose(x_m: float, y_m: float, yaw_rad: float) -> Pose2:
    return Pose2(x_m=float(x_m), y_m=float(y_m), yaw_rad=0.0) @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=float(yaw_rad))


if __name__ == "__main__":
    main()
