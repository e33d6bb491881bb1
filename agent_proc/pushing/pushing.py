"""Pushing the box to its goal: stage after stage along a planned path, each followed push by push."""

from collections import deque
from collections.abc import Callable, Sequence
from math import hypot, radians
from typing import Final

from msgspec.structs import replace

from agent_proc.endings import MissionEndedError
from agent_proc.frames.poses import BoxError
from agent_proc.frames.push_view import PushView, push_view
from agent_proc.policies.policy import Policy
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.map import PushMap
from agent_proc.pushing.follower import Follower, StageEnding
from agent_proc.pushing.obstacles import is_in_push
from agent_proc.pushing.queries import calibration_query, query_for_box
from agent_proc.pushing.reference_stage import reference_path
from agent_proc.pushing.stage import Stage
from agent_proc.pushing.stage import stages as path_stages
from agent_proc.task.reward_tuned import tuned_reward
from agent_proc.walking.actor import STILL_CYCLES, Actor
from agent_proc.walking.obstacles import in_words
from legpush.geometry import Pose2, distance_m
from legpush.messages.common import USUAL_DEPTH_M
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Push
from legpush.runs.report import Reason
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.paths import path_length_m
from legpush.scene.reference import Reference, least_radius_m
from legpush.scene.robot import FRONT_LEGS
from legpush.scene.scenario import Face, Goal

LEAST_PUSH_M: Final = 0.005
"""The box is stuck when `STILL_CYCLES` pushes in a row move it less than this."""
LEAST_TURN_RAD: Final = radians(0.5)
"""The same for its heading."""
MAX_PATHS: Final = 20
"""Paths of the box that are begun at most."""
AIM_M: Final = 0.02
AIM_DEG: Final = 2.0
MAX_BETTER: Final = 2
"""A box that is within its tolerances, but not within these, is pushed on so many times at most."""

STRAIGHT_WITHIN_M: Final = 0.005
"""A path that is longer by more than this than its ends are apart is not straight."""
CALIBRATION_LEGS: Final = (0, 1, 1, 0)
"""0 is FL, 1 is FR: the box turns to and fro, and goes straight on in the mean."""


class Pushing:
    """The pushes of a mission."""

    def __init__(self, actor: Actor, policy: Policy, push_map: PushMap | None = None) -> None:
        self._actor = actor
        self._policy = policy
        self._estimates = {
            face: PushEstimate(pushed_box(actor.scenario.box, face), None if push_map is None else push_map.model(face))
            for face in actor.faces()
        }
        """What pushes at each face do."""
        self._reference = actor.scenario.reference
        """Until it has been followed."""
        self._is_known = not actor.scenario.pushing.calibration_pushes
        """Whether the box need not be calibrated any more."""
        self.n_cycles = 0
        """Pushes up to now."""
        self._first: PushView | None = None
        """Before the first push."""
        self._n_cleared = 0
        """So many of the obstacles that have appeared are known not to be in the way of the present path."""

    def run(self) -> None:
        """Push along the reference, if there is one, or the path of the box, and plan anew where that was left, or did
        not lead to the goal.

        A box within the tolerances is pushed on, a few times at most, until it is within the aim as well.
        """
        to_do = self._reference is not None or not self._actor.box_error().within(self._aim())
        if self._actor.scenario.pushing.calibration_pushes and to_do:
            self._calibrate()
        self._is_known = True
        if self._reference is not None:
            self._push_along_reference()
        n_good = 0
        for _ in range(MAX_PATHS):
            before = self._actor.box_error()
            n_good += before.within(self._actor.scenario.goal)
            if before.within(self._aim()) or n_good > MAX_BETTER:
                return None
            to_the_end = self._push_along(self._come_to_push())
            error = self._actor.box_error()
            if self._actor.scenario.pushing.composition == "open_loop":
                return self._actor.require_goal("tolerance_missed", f"the open loop ended at box error {error}")
            if to_the_end and not n_good and not _is_better(error, before):
                return self._actor.require_goal("tolerance_missed", f"pushing ended at box error {error}")
        return self._actor.require_goal(
            "tolerance_missed", f"box error {self._actor.box_error()} after {MAX_PATHS} paths"
        )

    def _calibrate(self) -> None:
        """Some pushes straight ahead, with both legs in turn, so that paths are planned for the box as it is.

        None where there is no space for them, and no more once an obstacle appears.
        """
        face = self._come_to_push()[0].face
        estimate, n_pushes = self._estimates[face], self._actor.scenario.pushing.calibration_pushes
        ahead = calibration_query(self._actor.scenario, self._actor.seed, self._actor.box(), face, estimate)
        plan = self._actor.ask(ahead, "the way for the calibration")
        if plan.status != "exact" or plan.length_m > distance_m(ahead.start, ahead.goal) + STRAIGHT_WITHIN_M:
            return
        w1, w2 = estimate.curve
        n_known = self._actor.n_appeared()
        for index in range(min(n_pushes, self._actor.scenario.mission.max_push_cycles)):
            if self._actor.n_appeared() > n_known:
                return
            self._actor.tell("calibrating", index / n_pushes, f"push {index + 1} of {n_pushes}, {face} face")
            leg = FRONT_LEGS[CALIBRATION_LEGS[index % len(CALIBRATION_LEGS)]]
            self._push(Push(w1=w1, w2=w2, leg=leg, depth_m=USUAL_DEPTH_M, face=face), learn=True)

    def _push(self, push: Push, *, learn: bool) -> None:
        """One push, from which the estimate may learn."""
        face = push.face
        if not self._actor.at_station(face):
            self._actor.approach(face)
        self.n_cycles += 1
        before, view = pushed_pose(self._actor.box(), face), push_view(self._actor.state, self._actor.scenario)
        self._first = self._first or view
        self._actor.step(push)
        after = push_view(self._actor.state, self._actor.scenario)
        # What the same push earns in training; policies do not see it here.
        self._actor.world.tell_reward(tuned_reward(self._first, view, after, arrived=False))
        if learn:
            self._estimates[face].learn(before, push, pushed_pose(self._actor.box(), face))

    def _push_along_reference(self) -> None:
        """To its end; a mission that leaves it is over."""
        stages = self._come_to_push()
        self._reference = None
        if not self._push_along(stages, to_end=True):
            raise MissionEndedError("left_reference", f"the box left its reference after {self.n_cycles} push cycles")
        if self._actor.scenario.pushing.composition == "open_loop":
            self._actor.require_goal("tolerance_missed", f"the open loop ended at box error {self._actor.box_error()}")

    def _push_along(self, stages: list[Stage], *, to_end: bool = False) -> bool:
        """Stage after stage, with a walk around the box in between; whether the box came to the end of the path."""
        for index, path in enumerate(stages):
            if not self._actor.at_station(path.face) and not self._change_face(path.face):
                return False
            if self._follow(stages[index:], to_end=to_end) == "left_path":
                return False
        return True

    def _change_face(self, face: Face) -> bool:
        """Walk around the box, if there is a way."""
        self._actor.back_off()
        plan = self._actor.ask(self._actor.query_behind(face), "the way to another face of the box")
        if plan.status != "exact":
            return False
        return self._actor.walk_behind(face, plan)

    def _come_to_push(self) -> list[Stage]:
        """Plan the path of the box and walk to the face where it begins."""
        while True:
            stages, plan = self.way_to_push(self._actor.box(), self._actor.query_behind, "the way behind the box")
            if plan is None or self._actor.walk_behind(stages[0].face, plan):
                return stages

    def way_to_push(self, box: Pose2, query: Callable[[Face], PlanQuery], what: str) -> tuple[list[Stage], Plan | None]:
        """The path of a box, and the robot's way to its first face if it does not stand there: of those paths whose
        first face can be reached, the planner's favourite.
        """
        faces = self._actor.faces() if self._reference is None else ("rear",)
        while True:
            stages = self._box_stages(box, faces)
            first = stages[0].face
            if self._actor.at_station(first):
                return stages, None
            self._actor.back_off()
            plan = self._actor.ask(query(first), what)
            if plan.status == "exact":
                return stages, plan
            faces = tuple(face for face in faces if face != first)
            if not faces:
                raise self._actor.no_path(what, plan)

    def _box_stages(self, box: Pose2, faces: tuple[Face, ...]) -> list[Stage]:
        """The reference, or the planned path of the box: with the least clearance where it has come closer to something
        than planned.
        """
        if self._reference is not None:
            stages = [self._reference_path(self._reference)]
            self._require_free(stages)
            return stages
        self._n_cleared = self._actor.n_appeared()
        present = self._actor.standing_at()
        estimates = {face: self._estimates[face] for face in faces}
        query = query_for_box(self._actor.scenario, self._actor.seed, box, estimates, present)
        plan = self._actor.ask(query, "the path of the box")
        if plan.status == "invalid" and self.n_cycles and query.clearance_m > 0.0:
            plan = self._actor.ask(replace(query, clearance_m=0.0), "the path of the box, closer to obstacles")
        if plan.status != "exact":
            raise self._actor.no_path("the path of the box", plan)
        return path_stages(plan, {face: estimate.axle_m for face, estimate in estimates.items()})

    def _reference_path(self, reference: Reference) -> Stage:
        """Whatever place the box has: the reference begins at its nominal one."""
        estimate = self._estimates["rear"]
        tightest_m, radius_m = least_radius_m(reference), hypot(estimate.turning_radius_m, estimate.axle_m)
        if tightest_m < radius_m and self._is_known:
            raise MissionEndedError(
                "no_path",
                f"the reference turns on a radius of {tightest_m:.2f} m, the box on no less than {radius_m:.2f} m",
            )
        return reference_path(reference, self._actor.scenario.box.pose.pose(), estimate.axle_m)

    def _is_free(self, stages: Sequence[Stage], from_m: float = 0.0) -> bool:
        """Whether nothing has appeared in the way of box and robot, from a place on the first stage on."""
        for new in self._actor.appeared_since(self._n_cleared):
            for index, path in enumerate(stages):
                if is_in_push(new, self._actor.scenario, path, 0.0 if index else from_m):
                    return False
        self._n_cleared = self._actor.n_appeared()
        return True

    def _require_free(self, stages: Sequence[Stage], from_m: float = 0.0) -> None:
        """A reference that something has appeared in the way of ends the mission: there is no other."""
        if not self._is_free(stages, from_m):
            new = in_words(self._actor.state.appeared[self._n_cleared :])
            raise MissionEndedError("no_path", f"the reference is not free any more; appeared: {new}")

    def _aim(self) -> Goal:
        """The goal with tolerances no wider than the aim."""
        goal = self._actor.scenario.goal
        return replace(
            goal,
            position_tolerance_m=min(goal.position_tolerance_m, AIM_M),
            angle_tolerance_deg=min(goal.angle_tolerance_deg, AIM_DEG),
        )

    def _stop(self, reason: Reason, detail: str, to_end: bool) -> StageEnding:
        """Short of the end of a stage: the mission is over unless the box is at its goal, and that will do."""
        if to_end:
            raise MissionEndedError(reason, detail)
        self._actor.require_goal(reason, detail)
        return "done"

    def _follow(self, stages: Sequence[Stage], *, to_end: bool) -> StageEnding:
        """Push along the first of the stages that are left until it ends, the box has left it, or, in a closed loop, an
        obstacle has appeared in the way; with `to_end`, being at the goal before is not enough.
        """
        path = stages[0]
        max_cycles = self._actor.scenario.mission.max_push_cycles
        closed = self._actor.scenario.pushing.composition == "closed_loop"
        follower = Follower(path, self._policy, self._actor.scenario, self._estimates[path.face])
        boxes = deque([self._actor.box()], STILL_CYCLES + 1)
        while True:
            error = self._actor.box_error()
            decision = follower.decide(self._actor.state)
            share = min(1.0, decision.deviation.distance_m / path.length_m) if path.length_m > 0.0 else None
            self._actor.tell("pushing", share, f"cycle {self.n_cycles}, box error {error}")
            if decision.push is None:
                return decision.ending or "done"
            if closed and to_end:
                self._require_free(stages, decision.deviation.distance_m)
            elif closed and not self._is_free(stages, decision.deviation.distance_m):
                self._actor.give_up("the box", self._n_cleared)
                return "left_path"
            if self.n_cycles >= max_cycles:
                return self._stop("max_push_cycles", f"box error {error} after {self.n_cycles} push cycles", to_end)
            self._push(decision.push, learn=closed)
            boxes.append(self._actor.box())
            if len(boxes) > STILL_CYCLES and path_length_m((boxes[0], boxes[-1])) < LEAST_PUSH_M:
                return self._stop(
                    "stuck", f"the box did not move in {STILL_CYCLES} push cycles, box error {error}", to_end
                )


def _is_better(error: BoxError, before: BoxError) -> bool:
    """Whether pushing has brought the box nearer to its goal pose by more than chance would."""
    return error.position_m < before.position_m - LEAST_PUSH_M or error.angle_rad < before.angle_rad - LEAST_TURN_RAD
