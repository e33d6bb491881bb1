"""What is drawn beside the bodies at a row of a timeline, as arrays of points; pure, world frame."""

from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2, rpy_from_quaternion
from legpush.history.run_history import RunHistory
from legpush.history.timeline import BOX, Timeline, TimelineStep
from legpush.messages.planning import BoxPathQuery, Plan
from legpush.messages.stepping import Follow, Push
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.robot import FOOT_RADIUS_M, LEGS
from sim_proc.control.push_cycle import PUSH_SHIFT_TICKS, contact_point
from sim_proc.control.swing import bezier, control_points
from sim_proc.kinematics.body import LOADED_N

FORCE_M_PER_N: Final = 0.0025
TRAIL_ROWS: Final = 160
"""Ticks of the foot traces."""
TRAIL_STRIDE: Final = 4
PATH_POINTS: Final = 80
"""Of a path, at most: wide lines are what a page without a GPU draws most slowly."""
CURVE_POINTS: Final = 24
BOX_TRACE_TICKS: Final = 10
MAX_BOX_POINTS: Final = 1000
"""Of the trace of the box, which is coarser the longer the episode is."""
ON_FLOOR_M: Final = 0.006
"""Height at which paths are drawn, so that the floor does not hide them."""


class Curve(NamedTuple):
    """The Bezier curve of a push."""

    points_m: Floats
    """(`CURVE_POINTS`, 3)"""
    control_m: Floats
    """(4, 3)"""


def segments(points_m: Floats) -> Floats:
    """The lines between consecutive points (n, 3), (n - 1, 2, 3)."""
    return np.stack([points_m[:-1], points_m[1:]], axis=1)


def on_floor(points_m: Floats, height_m: float = ON_FLOOR_M) -> Floats:
    """Points of the plane (n, 2) just above it, (n, 3)."""
    return np.column_stack([points_m, np.full(len(points_m), height_m)])


def support_polygon(timeline: Timeline, row: int) -> Floats:
    """Corners of the convex hull of the feet that stand, counter-clockwise, on the floor, (k, 3), k in 0 to 4."""
    loaded = timeline.contact_forces_n[row, :, 2] >= LOADED_N
    points = timeline.tips_m[row, loaded, :2]
    if len(points) == len(LEGS):
        points = points[hull(points)]
    elif len(points) == 3 and _cross(points[1] - points[0], points[2] - points[0]) < 0.0:
        points = points[::-1]
    return on_floor(points)


def contact_arrows(timeline: Timeline, row: int) -> Floats:
    """From each foot as far as its contact force reaches, (4, 2, 3); without length where nothing is known of it."""
    tips = timeline.tips_m[row]
    forces = np.nan_to_num(timeline.contact_forces_n[row])
    return np.stack([tips, tips + FORCE_M_PER_N * forces], axis=1)


def foot_traces(timeline: Timeline, row: int) -> Floats:
    """Where the feet were in the last `TRAIL_ROWS` ticks, (4, n, 2, 3), n fixed: what is missing has no length."""
    n = TRAIL_ROWS // TRAIL_STRIDE
    rows = timeline.rows_at(timeline.tick[row] - TRAIL_STRIDE * np.arange(n, -1, -1))
    tips = timeline.tips_m[rows]
    return np.stack([tips[:-1], tips[1:]], axis=2).transpose(1, 0, 2, 3)


def box_trace(timeline: Timeline, row: int) -> Floats:
    """Where the box was since the beginning, on the floor, (n, 3)."""
    first, last = timeline.tick[0], timeline.tick[row]
    stride = BOX_TRACE_TICKS * np.ceil((last - first) / (BOX_TRACE_TICKS * MAX_BOX_POINTS) or 1.0)
    rows = np.unique(np.append(timeline.rows_at(np.arange(first, last, stride)), row))
    return on_floor(timeline.qpos[rows, BOX][:, :2])


def push_curve(timeline: Timeline, step: TimelineStep) -> Curve | None:
    """The curve that a push gives its foot (Eqs. 13, 14); None for another step, or one without a trace."""
    push = step.motion
    if not isinstance(push, Push) or step.n_rows <= PUSH_SHIFT_TICKS or not step.first_row:
        return None
    box = timeline.qpos[step.first_row - 1, BOX]
    yaw = float(rpy_from_quaternion(box[3:])[2])
    pose = pushed_pose(Pose2(x_m=float(box[0]), y_m=float(box[1]), yaw_rad=yaw), push.face)
    start = timeline.tips_m[step.first_row + PUSH_SHIFT_TICKS - 1, LEGS.index(push.leg)]
    goal = contact_point(pose, pushed_box(timeline.scenario.box, push.face), push.leg, push.depth_m)
    control = control_points(start, goal, push.w1, push.w2, push.locus, FOOT_RADIUS_M)
    return Curve(bezier(control, np.linspace(0.0, 1.0, CURVE_POINTS)), control)


def followed_path(timeline: Timeline, row: int) -> Floats:
    """The path of the trunk that the last `Follow` up to a row gave, (n, 3)."""
    motions = (timeline.steps[index].motion for index in range(timeline.step_index_at(row), -1, -1))
    paths = (motion.waypoints for motion in motions if isinstance(motion, Follow))
    return _waypoints(next(paths, ()))


def plan_at(timelines: RunHistory, timeline: Timeline, row: int, kind: str) -> Plan | None:
    """The last plan of the `box` or the `trunk` that was there at a row, with a path in it."""
    if not timelines.plans:
        return None
    began, ended = timelines.span_ns(timeline)
    for planned in reversed(timelines.plans):
        is_wanted = isinstance(planned.query, BoxPathQuery) == (kind == "box") and planned.plan.waypoints
        if is_wanted and began <= planned.time_ns <= ended and timeline.row_at(planned.time_ns) <= row:
            return planned.plan
    return None


def plan_path(plan: Plan) -> Floats:
    """Its waypoints, (n, 3)."""
    return _waypoints(plan.waypoints)


def plan_tree(plan: Plan) -> Floats:
    """The edges of its search tree, (n, 2, 3)."""
    if plan.tree is None or not plan.tree.points_m:
        return np.empty((0, 2, 3))
    points = on_floor(np.array(plan.tree.points_m), ON_FLOOR_M / 2)
    return np.stack([points[list(plan.tree.parents)], points], axis=1)


def _waypoints(waypoints: tuple[Pose2, ...]) -> Floats:
    points = np.array([[pose.x_m, pose.y_m] for pose in waypoints]).reshape(-1, 2)
    if not len(points):
        return np.empty((0, 3))
    return on_floor(points[np.unique(np.linspace(0, len(points) - 1, PATH_POINTS).round().astype(np.intp))])


def hull(points: Floats) -> list[int]:
    """Indices of the convex hull of 4 points (4, 2), counter-clockwise."""
    about = points - points.mean(axis=0)
    order = [int(i) for i in np.argsort(np.arctan2(about[:, 1], about[:, 0]))]
    around = [order[-1], *order, order[0]]
    corners = [b for (a, b), c in zip(pairwise(around), around[2:], strict=False) if _turns_left(points, a, b, c)]
    return corners or order


def _turns_left(points: Floats, a: int, b: int, c: int) -> bool:
    return _cross(points[b] - points[a], points[c] - points[b]) > 0.0


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
