"""Makes a path of the trunk fit the body of the robot: where it turns beside a wall, it turns elsewhere."""

from math import inf
from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.planning import Plan, TrunkPathQuery
from planner_proc.body import lattice
from planner_proc.body.motion import filled
from planner_proc.body.shortening import shortened
from planner_proc.body.space import BodySpace
from planner_proc.clearance.field import ClearanceField

WITHIN_M: Final = (1.0, 2.5, 8.0)
"""How far from the path of the disc to look for one of the body, in turn."""
WAYPOINT_M: Final = 0.05
WAYPOINT_RAD: Final = 0.2
"""Greatest distance and turn between two waypoints."""


class BodyFitting:
    """Checks the plans for one query, and replaces the first that does not fit; the replacement is kept."""

    def __init__(self, query: TrunkPathQuery, field: ClearanceField) -> None:
        """Take a query with a `body`, and the `field` of its grid."""
        if query.body is None:
            raise ValueError("Expected a query with a body")
        self._query = query
        self._field = field
        self._space = BodySpace(query.grid, field, query.clearance_m, query.body, query.body_clearance_m)
        self._replacement: Plan | None = None

    def fitted(self, plan: Plan) -> Plan:
        """The plan if the body keeps its clearance all along it, else one whose body does; `failed` if there is none.

        A curve of Dubins or Reeds and Shepp is not replaced, because the robot is not to turn on the spot then.
        """
        poses = np.array([[*waypoint.xy(), waypoint.yaw_rad] for waypoint in plan.waypoints])
        if self._space.body_is_free(filled(poses)).all():
            return plan
        if self._query.steering != "straight" or self._query.min_turning_radius_m > 0.0:
            return self._failed(plan, "it comes too near to something on the curve that was found")
        if self._replacement is None:
            self._replacement = self._replaced(plan, poses)
        return self._replacement

    def _replaced(self, plan: Plan, path: Floats) -> Plan:
        """A path of the body near the path of the disc."""
        start, goal = path[0], path[-1]
        step_m = max(lattice.LEAST_STEP_M, self._query.grid.resolution_m)
        for within_m in WITHIN_M:
            poses = lattice.search(self._space, start, goal, filled(path, step_m, inf)[:, :2], within_m, step_m)
            if len(poses):
                return self._plan(plan, shortened(poses, self._space))
        return self._failed(plan, f"no way for the body within {WITHIN_M[-1]:g} m of a way of the disc")

    def _plan(self, plan: Plan, poses: Floats) -> Plan:
        """The plan with these poses as its path."""
        dense = filled(poses, WAYPOINT_M, WAYPOINT_RAD)
        inner = tuple(Pose2(x_m=x, y_m=y, yaw_rad=wrap_angle(yaw)) for x, y, yaw in dense[1:-1].tolist())
        waypoints = (self._query.start, *inner, self._query.goal)
        if len(waypoints) > (n_most := self._query.smoothing.max_waypoints):
            return self._failed(plan, f"{len(waypoints)} waypoints: raise max_waypoints, which is {n_most}")
        length_m = float(np.hypot(*np.diff(dense[:, :2], axis=0).T).sum())
        return replace(
            plan,
            reason=f"{plan.reason}; {length_m:.2f} m for the body",
            waypoints=waypoints,
            length_m=length_m,
            min_clearance_m=self._field.path_clearance_m(dense[:, :2]),
        )

    def _failed(self, plan: Plan, why: str) -> Plan:
        body_m = self._query.body_clearance_m
        reason = f"The body of the robot does not keep {body_m:g} m everywhere: {why}"
        return Plan(status="failed", reason=reason, tree=plan.tree, n_iterations=plan.n_iterations)
