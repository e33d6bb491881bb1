"""Lines and arrows drawn beside the bodies at a row of a timeline, as arrays of points in the world frame."""

from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2, rpy_from_quaternion
from legpush.history.run_history import RunHistory
from legpush.history.timeline import BOX, Timeline, TimelineStep
from legpush.messages.planning import BoxPathQuery, Plan
from legpush.messages.stepping import Follow, Push
from legpush.scene.conventions import LEGS, LOADED_N
from sim_proc.control.push_cycle import contact_point
from sim_proc.control.swing import bezier, control_points

FORCE_M_PER_N: Final = 0.0025
"""Scale of the arrows of forces."""
TRAIL_ROWS: Final = 160
TRAIL_STRIDE: Final = 4
"""Length of the foot traces, and the distance of their points, in ticks."""
PATH_POINTS: Final = 80
"""Most points of a path. A page without a GPU draws wide lines slowly."""
CURVE_POINTS: Final = 24
BOX_TRACE_TICKS: Final = 10
"""Ticks between points of the trace of the box."""
MAX_BOX_POINTS: Final = 1000
"""Most points of that trace; it gets coarser in a longer episode."""
ON_FLOOR_M: Final = 0.006
"""Height at which paths are drawn, so that the floor does not hide them."""


class Curve(NamedTuple):
    """The Bezier curve of a push."""

    points_m: Floats
    """Points on the curve, (`CURVE_POINTS`, 3)."""
    control_m: Floats
    """Control points, (4, 3)."""


def segments(points_m: Floats) -> Floats:
    """Lines between consecutive points (n, 3), as (n - 1, 2, 3)."""
    return np.stack([points_m[:-1], points_m[1:]], axis=1)


def on_floor(points_m: Floats, height_m: float = ON_FLOOR_M) -> Floats:
    """Points on the floor (n, 2), raised to a height above it, (n, 3)."""
    return np.column_stack([points_m, np.full(len(points_m), height_m)])


def support_polygon(timeline: Timeline, row: int) -> Floats:
    """Convex hull of the standing feet on the floor, counter-clockwise, (k, 3) with k from 0 to 4."""
    loaded = timeline.contact_forces_n[row, :, 2] >= LOADED_N
    points = timeline.tips_m[row, loaded, :2]
    if len(points) == len(LEGS):
        points = points[hull(points)]
    elif len(points) == 3 and _cross(points[1] - points[0], points[2] - points[0]) < 0.0:
        points = points[::-1]
    return on_floor(points)


def contact_arrows(timeline: Timeline, row: int) -> Floats:
    """The contact force of each foot as an arrow, (4, 2, 3). The arrow of an unknown force has no length."""
    tips = timeline.tips_m[row]
    forces = np.nan_to_num(timeline.contact_forces_n[row])
    return np.stack([tips, tips + FORCE_M_PER_N * forces], axis=1)


def foot_traces(timeline: Timeline, row: int) -> Floats:
    """Lines along the feet in the last `TRAIL_ROWS` ticks, (4, n, 2, 3). n is fixed; missing lines have no length."""
    n = TRAIL_ROWS // TRAIL_STRIDE
    rows = timeline.rows_at(timeline.tick[row] - TRAIL_STRIDE * np.arange(n, -1, -1))
    tips = timeline.tips_m[rows]
    return np.stack([tips[:-1], tips[1:]], axis=2).transpose(1, 0, 2, 3)


def box_trace(timeline: Timeline, row: int) -> Floats:
    """The path of the box on the floor since the beginning, (n, 3)."""
    first, last = timeline.tick[0], timeline.tick[row]
    stride = BOX_TRACE_TICKS * np.ceil((last - first) / (BOX_TRACE_TICKS * MAX_BOX_POINTS) or 1.0)
    rows = np.unique(np.append(timeline.rows_at(np.arange(first, last, stride)), row))
    return on_floor(timeline.qpos[rows, BOX][:, :2])


def push_curve(timeline: Timeline, step: TimelineStep) -> Curve | None:
    """The curve of the foot in a push (Eqs. 14, 15); None if the step is no push or has no trace."""
    push, robot = step.motion, timeline.scenario.robot
    shift_ticks = robot.pushing.shift_ticks
    if not isinstance(push, Push) or step.n_rows <= shift_ticks or not step.first_row:
        return None
    box = timeline.qpos[step.first_row - 1, BOX]
    yaw = float(rpy_from_quaternion(box[3:])[2])
    pose = Pose2(x_m=float(box[0]), y_m=float(box[1]), yaw_rad=yaw)
    start = timeline.tips_m[step.first_row + shift_ticks - 1, LEGS.index(push.leg)]
    goal = contact_point(robot, timeline.scenario.box, pose, push.face, push.leg, push.depth_m)
    control = control_points(start, goal, (push.w1, push.w2), push.locus, robot.legs.foot_radius_m)
    return Curve(bezier(control, np.linspace(0.0, 1.0, CURVE_POINTS)), control)


def followed_path(timeline: Timeline, row: int) -> Floats:
    """The path of the last `Follow` up to a row, (n, 3)."""
    motions = (timeline.steps[index].motion for index in range(timeline.step_index_at(row), -1, -1))
    paths = (motion.waypoints for motion in motions if isinstance(motion, Follow))
    return _waypoints(next(paths, ()))


def plan_at(history: RunHistory, timeline: Timeline, row: int, kind: str) -> Plan | None:
    """The last plan with a path for the `box` or the `trunk` that existed at a row; None without one."""
    if not history.plans:
        return None
    began, ended = history.span_ns(timeline)
    for planned in reversed(history.plans):
        is_wanted = isinstance(planned.query, BoxPathQuery) == (kind == "box") and planned.plan.waypoints
        if is_wanted and began <= planned.time_ns <= ended and timeline.row_at(planned.time_ns) <= row:
            return planned.plan
    return None


def plan_path(plan: Plan) -> Floats:
    """Waypoints of a plan on the floor, (n, 3)."""
    return _waypoints(plan.waypoints)


def plan_tree(plan: Plan) -> Floats:
    """Edges of the search tree of a plan on the floor, (n, 2, 3)."""
    if plan.tree is None or not plan.tree.points_m:
        return np.empty((0, 2, 3))
    points = on_floor(np.array(plan.tree.points_m), ON_FLOOR_M / 2)
    return np.stack([points[list(plan.tree.parents)], points], axis=1)


def _waypoints(waypoints: tuple[Pose2, ...]) -> Floats:
    """At most `PATH_POINTS` of the waypoints, (n, 3)."""
    points = np.array([[pose.x_m, pose.y_m] for pose in waypoints]).reshape(-1, 2)
    if not len(points):
        return np.empty((0, 3))
    return on_floor(points[np.unique(np.linspace(0, len(points) - 1, PATH_POINTS).round().astype(np.intp))])


def hull(points: Floats) -> list[int]:
    """Indices of the corners of the convex hull of four points (4, 2), counter-clockwise."""
    about = points - points.mean(axis=0)
    order = [int(i) for i in np.argsort(np.arctan2(about[:, 1], about[:, 0]))]
    around = [order[-1], *order, order[0]]
    corners = [b for (a, b), c in zip(pairwise(around), around[2:], strict=False) if _turns_left(points, a, b, c)]
    return corners or order


def _turns_left(points: Floats, a: int, b: int, c: int) -> bool:
    return _cross(points[b] - points[a], points[c] - points[b]) > 0.0


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
