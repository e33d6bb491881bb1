"""Faults of a path of the trunk: its status, its ends, its motion, and its exact distance to occupied cells."""

from collections.abc import Sequence
from math import hypot, pi
from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.geometry import Pose2, wrap_angle
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.scene.clearance import Occupied, clearance, xy_of
from legpush.scene.paths import poses_along

SAME_M: Final = 1e-6
"""Positions and distances that differ by less count as equal."""
SAME_RAD: Final = 1e-6
"""Headings that differ by less count as equal."""
RADIUS_SHARE: Final = 0.05
"""By which share a turning radius may be missed: waypoints are rounded and placed unevenly."""
FORWARD_SHARE: Final = 0.9
"""Least share of a step that leads along the heading: with less, it leads sideways or backward."""
BODY_STEP_M: Final = 0.02
"""How far a point of the body moves between two poses that are looked at; half of it is forgiven."""
LONGEST_STEP_M: Final = 0.25
"""Greatest distance between two waypoints: more would say too little about the headings in between."""


def faults(query: TrunkPathQuery, plan: Plan) -> list[str]:
    """Everything in a plan that contradicts the protocol; empty for an honest plan."""
    if plan.status in ("failed", "invalid"):
        return [] if plan.reason else [f"its status is {plan.status}, and its reason is empty"]
    if not plan.waypoints:
        return [f"its status is {plan.status}, and it has no waypoints"]
    found = [*_end_faults("begins", plan.waypoints[0], query.start)]
    if plan.status == "exact":
        found += _end_faults("ends", plan.waypoints[-1], query.goal)
    points = np.array([waypoint.xy() for waypoint in plan.waypoints])
    nearest = clearance(query.grid, points)
    if nearest.distance_m < query.clearance_m - SAME_M:
        x_m, y_m = nearest.at_m
        found.append(
            f"it collides: near ({x_m:.2f}, {y_m:.2f}) it is {nearest.distance_m:.3f} m from something occupied, "
            f"{query.clearance_m:g} m were asked for"
        )
    found += _steering_faults(query, plan.waypoints)
    found += body_faults(query, plan)
    steps_m = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.zeros(1)
    if steps_m.max() > LONGEST_STEP_M:
        found.append(f"waypoints are up to {steps_m.max():.2f} m apart, expected at most {LONGEST_STEP_M:g} m")
    return found


def body_faults(query: TrunkPathQuery, plan: Plan) -> list[str]:
    """Where the body of the robot does not keep its clearance, at the waypoints or between them."""
    body = query.body
    if body is None or not plan.waypoints:
        return []
    occupied, turn_m = Occupied(query.grid), float(np.hypot(*body.corners().T).max())
    poses = poses_along(plan.waypoints, turn_m, 0.0, BODY_STEP_M)
    apart_m = [occupied.distance_m(replace(body, pose=pose @ body.pose)) for pose in poses]
    worst = int(np.argmin(apart_m))
    if apart_m[worst] >= query.body_clearance_m - BODY_STEP_M / 2:
        return []
    x_m, y_m = xy_of(poses[worst].xy())
    return [
        f"the body collides: near ({x_m:.2f}, {y_m:.2f}), at a heading of {poses[worst].yaw_rad:.2f} rad, it is "
        f"{apart_m[worst]:.3f} m from something occupied, {query.body_clearance_m:g} m were asked for"
    ]


def _steering_faults(query: TrunkPathQuery, waypoints: Sequence[Pose2]) -> list[str]:
    """Where a path turns on a smaller radius than it may, or moves backward although it may not."""
    radius_m = query.min_turning_radius_m
    if radius_m == 0.0:
        return []
    poses = np.array([[*waypoint.xy(), waypoint.yaw_rad] for waypoint in waypoints])
    poses = poses[np.concatenate([[True], np.hypot(*np.diff(poses[:, :2], axis=0).T) > SAME_M])]
    steps = np.diff(poses[:, :2], axis=0)
    lengths_m = np.hypot(*steps.T)
    found = []
    if len(poses) > 2:
        before, after = steps[:-1], steps[1:]
        goes_on = (before * after).sum(axis=1) > 0.0
        cross = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
        across_m = np.hypot(*(poses[2:, :2] - poses[:-2, :2]).T)
        bends = np.where(goes_on, 2.0 * cross / (lengths_m[:-1] * lengths_m[1:] * np.maximum(across_m, SAME_M)), 0.0)
        worst = int(bends.argmax())
        if bends[worst] > (1.0 + RADIUS_SHARE) / radius_m:
            x_m, y_m = xy_of(poses[worst + 1, :2])
            found.append(
                f"it turns on a radius of {1.0 / bends[worst]:.3g} m near ({x_m:.2f}, {y_m:.2f}), expected at least "
                f"{radius_m:g} m"
            )
    if query.steering == "dubins":
        middles = poses[:-1, 2] + 0.5 * ((poses[1:, 2] - poses[:-1, 2] + pi) % (2 * pi) - pi)
        along_m = steps[:, 0] * np.cos(middles) + steps[:, 1] * np.sin(middles)
        worst = int((along_m / lengths_m).argmin())
        if along_m[worst] < FORWARD_SHARE * lengths_m[worst]:
            x_m, y_m = xy_of(poses[worst, :2])
            found.append(f"near ({x_m:.2f}, {y_m:.2f}) it does not move forward along its heading")
    return found


def _end_faults(verb: str, got: Pose2, expected: Pose2) -> list[str]:
    """Where an end of the path misses the pose that is expected."""
    off_m = hypot(got.x_m - expected.x_m, got.y_m - expected.y_m)
    if off_m > SAME_M:
        hint = _unit_hint(got, expected)
        return [
            f"it {verb} at ({got.x_m:g}, {got.y_m:g}), {off_m:.3g} m from ({expected.x_m:g}, {expected.y_m:g}){hint}"
        ]
    if abs(wrap_angle(got.yaw_rad - expected.yaw_rad)) > SAME_RAD:
        hint = "; are these degrees?" if abs(got.yaw_rad) > 2 * pi else ""
        return [f"it {verb} with a heading of {got.yaw_rad:g} rad, expected {expected.yaw_rad:g}{hint}"]
    return []


def _unit_hint(got: Pose2, expected: Pose2) -> str:
    """What the numbers may be instead of metres along x and y; empty if they look like nothing else."""
    for factor, unit in ((100.0, "centimetres"), (1000.0, "millimetres")):
        if hypot(got.x_m / factor - expected.x_m, got.y_m / factor - expected.y_m) < 0.01:
            return f"; are these {unit}?"
    for factor in (20.0, 10.0):
        if hypot(got.x_m / factor - expected.x_m, got.y_m / factor - expected.y_m) < 0.5 / factor:
            return "; are these cells?"
    if hypot(got.y_m - expected.x_m, got.x_m - expected.y_m) < SAME_M:
        return "; are x and y the wrong way around?"
    return ""


def differences(one: Plan, other: Plan) -> str:
    """The first difference between two plans that should be equal; empty if they are."""
    if one == other:
        return ""
    for name in ("status", "reason", "length_m", "min_clearance_m", "n_iterations"):
        if getattr(one, name) != getattr(other, name):
            return f"`{name}` is {getattr(one, name)!r} and {getattr(other, name)!r}"
    rows: Sequence[tuple[str, Sequence[object], Sequence[object]]] = (
        ("waypoints", one.waypoints, other.waypoints),
        ("raw_path_m", one.raw_path_m, other.raw_path_m),
        ("sides", one.sides, other.sides),
    )
    for name, a, b in rows:
        if len(a) != len(b):
            return f"`{name}` has {len(a)} and {len(b)} entries"
        for index, (x, y) in enumerate(zip(a, b, strict=True)):
            if x != y:
                return f"`{name}[{index}]` is {x} and {y}"
    return "`tree` differs"
