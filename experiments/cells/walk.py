"""The kind of cell that measures speed, steadiness and accuracy of the crawl on a simple path.

Speed is the length of the path over the time from rest to rest; the cruising speed is that of the middle half.
"""

from collections.abc import Mapping, Sequence
from math import cos, degrees, pi, sin
from typing import Any, Final, Literal

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from legpush.geometry import Pose2, rpy_from_quaternion, wrap_angle
from legpush.messages.stepping import Follow, PathProgress, Reset, Trace, Walk
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.scenario import Room, Scenario
from legpush.study.cells import CellKind, Column, as_it_is
from sim_proc.simulator import Simulator

STEP_M: Final = 0.05
LIFTED_M: Final = 0.03
"""A foot whose centre is higher than this swings."""
PathName = Literal["straight", "circle_2_m", "circle_0.8_m", "s_curve", "turn_on_the_spot"]

COLUMNS: Final = (
    Column(name="length_m", unit="m", about="length of the path"),
    Column(name="time_s", unit="s", about="simulated time from rest to rest"),
    Column(name="speed_m_s", unit="m/s", about="length over time"),
    Column(name="cruising_speed_m_s", unit="m/s", about="speed in the middle half of the path"),
    Column(name="tracking_rms_m", unit="m", about="distance of the trunk from the path, root mean square"),
    Column(name="end_error_m", unit="m", about="distance of the trunk from the end of the path"),
    Column(name="end_yaw_error_deg", unit="deg", about="heading error at the end"),
    Column(name="max_abs_tilt_deg", unit="deg", about="largest roll or pitch of the trunk"),
    Column(name="min_support_margin_m", unit="m", about="least distance of the CoM from the border of its support"),
    Column(name="com_to_centroid_m", unit="m", about="mean distance of the CoM, seen from above, from Eq. 8"),
    Column(name="middle_to_centroid_m", unit="m", about="the same of the middle of all four feet"),
    Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state"),
)


class Walked(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A path to walk."""

    path: PathName


def walk(cell: Walked) -> Mapping[str, Any]:
    """Walk the path once and measure it.

    Raises:
        RuntimeError: The robot fell, or the walk ended early.
    """
    path = path_of(cell.path)
    simulator = Simulator()
    simulator.perform(Reset(scenario=_scenario(), seed=0), with_trace=False)
    simulator.perform(Follow(waypoints=tuple(path)), with_trace=False)
    traces: list[Trace] = []
    progress: list[tuple[float, PathProgress]] = []
    while not progress or not progress[-1][1].done:
        outcome = simulator.perform(Walk(), with_trace=True)
        if outcome.world.path is None or outcome.trace is None or outcome.world.fallen:
            raise RuntimeError(f"{cell.path}: the walk ended early")
        traces.append(outcome.trace)
        progress.append((outcome.world.tick * CONTROL_PERIOD_S, outcome.world.path))
    trunk = np.concatenate([np.array(trace.qpos)[:, :2] for trace in traces])
    points = np.array([[pose.x_m, pose.y_m] for pose in path])
    off = np.array([np.linalg.norm(points - here, axis=1).min() for here in trunk])
    length_m = progress[-1][1].length_m
    middle = [(s, p.travelled_m) for s, p in progress if 0.25 * length_m <= p.travelled_m <= 0.75 * length_m]
    (t0, s0), (t1, s1) = middle[0], middle[-1]
    last = outcome.world.trunk
    com_m, middle_m = centroid_distances_m(traces)
    end_yaw_rad = float(rpy_from_quaternion(last.orientation_wxyz)[2])
    return {
        "length_m": length_m,
        "time_s": progress[-1][0],
        "speed_m_s": length_m / progress[-1][0],
        "cruising_speed_m_s": (s1 - s0) / (t1 - t0),
        "tracking_rms_m": float(np.sqrt((off**2).mean())),
        "end_error_m": float(np.hypot(last.position_m[0] - path[-1].x_m, last.position_m[1] - path[-1].y_m)),
        "end_yaw_error_deg": abs(degrees(wrap_angle(end_yaw_rad - path[-1].yaw_rad))),
        "max_abs_tilt_deg": degrees(np.abs(np.concatenate([trace.roll_pitch_rad for trace in traces])).max()),
        "min_support_margin_m": min(min(trace.support_margin_m) for trace in traces),
        "com_to_centroid_m": com_m,
        "middle_to_centroid_m": middle_m,
        "state_crc": f"{outcome.state_crc:08x}",
    }


def centroid_distances_m(traces: Sequence[Trace]) -> tuple[float, float]:
    """Return how far the CoM, and the middle of the four feet, are on average from the centroid of the three feet that
    stand while the fourth swings (Eq. 8)."""
    tips, com = (np.concatenate([getattr(trace, name) for trace in traces]) for name in ("tips_m", "com_m"))
    swings = tips[:, :, 2] > LIFTED_M
    one = swings.sum(axis=1) == 1
    feet = tips[one, :, :2]
    centroid = (feet.sum(axis=1) - feet[swings[one]]) / 3
    com_m, middle_m = (
        float(np.linalg.norm(point - centroid, axis=1).mean()) for point in (com[one, :2], feet.mean(axis=1))
    )
    return com_m, middle_m


def path_of(name: PathName) -> list[Pose2]:
    """Return a path; it begins at (10, 10) and heads along x."""
    match name:
        case "straight":
            return _arc(6.0, 0.0)
        case "circle_2_m":
            return _arc(4 * pi, 1 / 2.0)
        case "circle_0.8_m":
            return _arc(1.6 * pi, 1 / 0.8)
        case "s_curve":
            return [*_arc(pi / 2, 1.0), *_arc(pi / 2, -1.0, _arc(pi / 2, 1.0)[-1])]
        case "turn_on_the_spot":
            return [_pose(10.0, 10.0, yaw) for yaw in np.linspace(0.0, pi, 40)]


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


WALK: Final = CellKind(specification=Walked, run=walk, resolved=Walked, resolve=as_it_is, columns=COLUMNS)
"""The kind of cell."""
