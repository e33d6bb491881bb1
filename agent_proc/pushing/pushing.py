"""Pushes the box to its goal: stage after stage along a path, push after push along each stage."""

from collections import deque
from collections.abc import Sequence
from math import radians
from typing import Final

from msgspec.structs import replace

from agent_proc.endings import MissionEndedError
from agent_proc.frames.poses import BoxError
from agent_proc.policies.policy import Policy
from agent_proc.pushing.box_route import BoxRoute
from agent_proc.pushing.calibrating import Calibration
from agent_proc.pushing.docking.docking import Docking
from agent_proc.pushing.follower import Follower, StageEnding
from agent_proc.pushing.pushes import Pushes
from agent_proc.pushing.stage import Stage
from agent_proc.walking.actor import Actor
from agent_proc.walking.stuck import STILL_CYCLES
from agent_proc.walking.walker import Walker
from legpush.scene.paths import path_length_m
from legpush.scene.scenario import Goal

STUCK_SHARE: Final = 0.1
"""The box is stuck if `STILL_CYCLES` pushes in a row move it less than this share of what they move the default box."""
LEAST_GAIN_M: Final = 0.005
LEAST_GAIN_RAD: Final = radians(0.5)
"""A path has brought the box nearer to its goal if one of its errors has shrunk by more than this."""
MAX_PATHS: Final = 20
"""Most paths of the box that are begun."""
AIM_M: Final = 0.02
AIM_DEG: Final = 2.0
MAX_BETTER: Final = 2
"""How many more times to push a box that meets its tolerances but not yet these tighter ones."""


class Pushing:
    """The second half of a mission, from the hand-over to its end."""

    def __init__(
        self,
        actor: Actor,
        walker: Walker,
        route: BoxRoute,
        pushes: Pushes,
        calibration: Calibration,
        policy: Policy,
    ) -> None:
        self._actor = actor
        self._walker = walker
        self._route = route
        self._pushes = pushes
        self._calibration = calibration
        self._policy = policy
        self._docking = Docking(actor, walker, pushes)

    def run(self) -> None:
        """Push along the reference, if there is one, then along planned paths until the box is at its goal.

        If the box has left a path, or that did not lead to the goal, a box that is near the goal is docked, and another
        path is planned for one that is farther away. A box within the tolerances is pushed on, a few times at most,
        until it is within the aim as well.

        Raises:
            MissionEndedError: The box is not at its goal.
        """
        to_do = self._route.reference is not None or not self._actor.box_error().within(self._aim())
        if self._route.calibration_is_due and to_do:
            self._calibration.run(self._route.come_to_push()[0].face)
        self._route.calibration_is_due = False
        if self._route.reference is not None:
            self._push_along_reference()
        n_good = 0
        for n_paths in range(MAX_PATHS):
            before = self._actor.box_error()
            n_good += before.within(self._actor.scenario.goal)
            if before.within(self._aim()) or n_good > MAX_BETTER:
                return None
            if (n_paths > 0 or self._docking.is_due()) and self._docking.run(self._aim()):
                return None
            to_the_end = self._push_along(self._route.come_to_push())
            error = self._actor.box_error()
            if self._actor.scenario.pushing.composition == "open_loop":
                return self._actor.require_goal("tolerance_missed", f"the open loop ended at box error {error}")
            if to_the_end and not n_good and not _is_better(error, before):
                return self._actor.require_goal("tolerance_missed", f"pushing ended at box error {error}")
        return self._actor.require_goal(
            "tolerance_missed", f"box error {self._actor.box_error()} after {MAX_PATHS} paths"
        )

    def _push_along_reference(self) -> None:
        """To its end; a mission that leaves it is over."""
        if not self._push_along(self._route.begin_reference(), to_end=True):
            raise MissionEndedError(
                "left_reference", f"the box left its reference after {self._pushes.n_cycles} push cycles"
            )
        if self._actor.scenario.pushing.composition == "open_loop":
            self._actor.require_goal("tolerance_missed", f"the open loop ended at box error {self._actor.box_error()}")

    def _push_along(self, stages: list[Stage], *, to_end: bool = False) -> bool:
        """Stage after stage, with a walk around the box in between; whether the box came to the end of the path.

        A path that does not move the box, because it is near enough to its goal, leaves nothing to push.
        """
        self._pushes.budget.take_path(stages, self._pushes.n_cycles)
        for index, stage in enumerate(stages):
            if stage.length_m == 0.0:
                continue
            if not self._actor.at_station(stage.face) and not self._walker.change_face(stage.face):
                return False
            if self._follow(stages[index:], to_end=to_end) == "left_path":
                return False
        return True

    def _follow(self, stages: Sequence[Stage], *, to_end: bool) -> StageEnding:
        """Push along the first of the stages that are left until it ends or is given up.

        It is given up if the box has left it or, in a closed loop, an obstacle has appeared in the way. With `to_end`,
        being at the goal before its end is not enough.
        """
        stage, scenario = stages[0], self._actor.scenario
        closed = scenario.pushing.composition == "closed_loop"
        estimate, is_last = self._pushes.estimates[stage.face], len(stages) == 1
        follower = Follower(stage, self._policy, scenario, estimate, is_last=is_last)
        boxes = deque([self._actor.box()], STILL_CYCLES + 1)
        commanded_m: deque[float] = deque(maxlen=STILL_CYCLES)
        while True:
            error, n_cycles = self._actor.box_error(), self._pushes.n_cycles
            decision = follower.decide(self._actor.state)
            at_m = decision.deviation.distance_m
            share = min(1.0, at_m / stage.length_m) if stage.length_m > 0.0 else None
            self._actor.tell("pushing", share, f"cycle {n_cycles}, box error {error}")
            if decision.push is None:
                return decision.ending or "done"
            if closed and to_end:
                self._route.require_free(stages, at_m)
            elif closed and not self._route.is_free(stages, at_m):
                self._route.give_up()
                return "left_path"
            if n_cycles >= self._pushes.budget.n_cycles:
                return self._stop(self._pushes.budget.used_up_on_path(stages, at_m, f"box error {error}"), to_end)
            self._pushes.push(decision.push, learn=closed)
            boxes.append(self._actor.box())
            commanded_m.append(estimate.commanded_m(decision.push.depth_m))
            moved_m = path_length_m((boxes[0], boxes[-1]), scenario.robot.stance.foot_circle_m)
            if len(boxes) > STILL_CYCLES and moved_m < STUCK_SHARE * sum(commanded_m):
                detail = (
                    f"{STILL_CYCLES} push cycles moved the box {1000 * moved_m:.1f} mm instead of "
                    f"{1000 * sum(commanded_m):.0f} mm, box error {error}"
                )
                return self._stop(MissionEndedError("stuck", detail, "lower `box.mass_kg` or `box.friction`"), to_end)

    def _stop(self, ending: MissionEndedError, to_end: bool) -> StageEnding:
        """Stop before the end of a stage. The mission ends unless the box is at its goal and `to_end` is false."""
        if to_end or not self._actor.box_error().within(self._actor.scenario.goal):
            raise ending
        return "done"

    def _aim(self) -> Goal:
        """The goal with tolerances no wider than the aim."""
        goal = self._actor.scenario.goal
        return replace(
            goal,
            position_tolerance_m=min(goal.position_tolerance_m, AIM_M),
            angle_tolerance_deg=min(goal.angle_tolerance_deg, AIM_DEG),
        )


def _is_better(error: BoxError, before: BoxError) -> bool:
    """Whether pushing has brought the box nearer to its goal pose by more than chance would."""
    return error.position_m < before.position_m - LEAST_GAIN_M or error.angle_rad < before.angle_rad - LEAST_GAIN_RAD
