"""Asks the planner for paths, refuses plans that cannot be followed, and keeps the better paths of the last plan."""

from collections.abc import Sequence
from itertools import groupby

from agent_proc.endings import MissionEndedError
from agent_proc.walking.actor import Actor
from agent_proc.walking.better_paths import BetterPaths
from agent_proc.walking.obstacles import in_words
from legpush.errors import BadAnswerError
from legpush.geometry import Pose2, distance_m, wrap_angle
from legpush.lockstep.world import World
from legpush.messages.planning import BoxPathQuery, Plan, PlanQuery, TrunkPathQuery
from legpush.scene.occupancy import clearance_m
from legpush.scene.paths import path_length_m


class RoutePlanner:
    """The planner, as a mission asks it."""

    def __init__(self, world: World, actor: Actor, seed: int) -> None:
        self._world = world
        self._actor = actor
        self.seed = seed
        """Part of every query, so that a mission can be repeated."""
        self.n_better_paths = 0
        """How often a better path was taken."""
        self.n_replans = 0
        """How often a path was given up because an obstacle appeared in it, or the robot was thrown off it."""
        self._better: BetterPaths | None = None
        """Of the last plan that was asked for."""

    def ask(self, query: PlanQuery, what: str) -> Plan:
        """The planner's answer, whatever its status; `what` names the path for people.

        Raises:
            BadAnswerError: The plan is called exact, but it cannot be followed.
        """
        self._actor.tell("planning", None, what)
        plan = self._world.plan(query)
        _require_followable(query, plan, what)
        self._better = None
        if isinstance(query, TrunkPathQuery) and query.anytime:
            self._better = BetterPaths(query, plan, self._actor.scenario.robot.stance.foot_circle_m)
        return plan

    def better_path(
        self, waypoints: tuple[Pose2, ...], travelled_m: float, last_stretch: tuple[Pose2, ...]
    ) -> tuple[Pose2, ...]:
        """A path from here on that is shorter than what is left of the present one, or nothing.

        The planner's next revision is waited for at each call but those at the beginning of the path, so that a mission
        can be repeated. `waypoints` end with the `last_stretch`, which no plan has, and so does the path returned.

        Raises:
            BadAnswerError: The revision is called exact, but it cannot be followed.
        """
        if self._better is None or travelled_m == 0.0 or (revision := self._better.next_revision()) is None:
            return ()
        circle_m = self._actor.scenario.robot.stance.foot_circle_m
        left_m = path_length_m(waypoints, circle_m) - travelled_m - path_length_m(last_stretch, circle_m)
        plan = self._world.revision(revision)
        _require_followable(self._better.query, plan, f"revision {revision} of the way")
        joined = self._better.joined(plan, self._actor.trunk(), left_m)
        if not joined:
            return ()
        self.n_better_paths += 1
        return joined + last_stretch

    def forget_better_paths(self) -> None:
        """Wait for no more revisions of the last plan: its map is out of date."""
        self._better = None

    def cancel(self) -> None:
        """Stop the planner from improving its last plan."""
        self.forget_better_paths()
        self._world.cancel_plan()

    def give_up(self, what: str, n_known: int) -> None:
        """Count that a path of robot or box is given up, and tell what has appeared beyond the first `n_known`."""
        self.n_replans += 1
        appeared = in_words(self._actor.state.appeared[n_known:])
        self._actor.tell("giving up a path", None, f"of {what}; appeared: {appeared}")

    def start_over(self, off_m: float) -> None:
        """Count and tell that a path of the robot is given up, as it was thrown off it."""
        self.n_replans += 1
        self._actor.tell("giving up a path", None, f"of the robot, which was thrown {off_m:.2f} m off it")

    def no_path(self, what: str, query: PlanQuery, plan: Plan) -> MissionEndedError:
        """The error to raise if a plan is not exact and the mission cannot go on without it."""
        state, scenario = self._actor.state, self._actor.scenario
        appeared = f"; appeared: {in_words(state.appeared)}" if state.appeared else ""
        walk = (
            f"lower `planning.margin_m` ({scenario.planning.margin_m:g} m), with which a walk needs passages of "
            f"{2 * clearance_m(scenario):.2f} m, or `planning.body_margin_m` ({scenario.planning.body_margin_m:g} m), "
            "which the body keeps where it turns"
        )
        if isinstance(query, TrunkPathQuery):
            remedy = f"{walk}, or raise `planning.max_iterations` ({scenario.planning.max_iterations})"
        else:
            pushing = scenario.pushing
            remedy = (
                f"lower `pushing.margin_m` ({pushing.margin_m:g} m) or `pushing.turning_reserve` "
                f"({pushing.turning_reserve:g}), raise `pushing.max_iterations` ({pushing.max_iterations}), or, where "
                f"the robot cannot come to a face, {walk}"
            )
        detail = f"{what}: the planner's answer is {plan.status}: {plan.reason}{appeared}"
        return MissionEndedError("no_path", detail, remedy)


def plan_fault(query: PlanQuery, plan: Plan) -> str:
    """Why an exact plan cannot be followed, or nothing; any program may be the planner."""
    if not plan.waypoints:
        return "it has no waypoints"
    if isinstance(query, TrunkPathQuery):
        return ""
    if len(plan.sides) != len(plan.waypoints):
        return f"it has {len(plan.waypoints)} waypoints and {len(plan.sides)} sides"
    if max(plan.sides) >= len(query.sides):
        return f"it names side {max(plan.sides)} of {len(query.sides)}"
    if not _moves(plan.waypoints):
        return "" if is_at_goal(query) else "the box does not move, although it is not at its goal"
    for _, stage in groupby(zip(plan.sides, plan.waypoints, strict=True), key=lambda item: item[0]):
        poses = [pose for _, pose in stage]
        if not _moves(poses):
            return f"the box does not move in the stage at ({poses[0].x_m:g}, {poses[0].y_m:g})"
    return ""


def is_at_goal(query: BoxPathQuery) -> bool:
    """Whether the box of a query is within the tolerances of its goal, so that a path need not move it."""
    off_rad = abs(wrap_angle(query.goal.yaw_rad - query.start.yaw_rad))
    return distance_m(query.start, query.goal) <= query.position_tolerance_m and off_rad <= query.angle_tolerance_rad


def _moves(poses: Sequence[Pose2]) -> bool:
    return any(distance_m(pose, poses[0]) > 0.0 for pose in poses)


def _require_followable(query: PlanQuery, plan: Plan, what: str) -> None:
    if plan.status == "exact" and (fault := plan_fault(query, plan)):
        raise BadAnswerError(f"{what}: expected a plan that can be followed, but {fault}")
