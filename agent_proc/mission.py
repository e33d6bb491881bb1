"""The mission (Fig. 5): plan, walk to the box, hand over, approach it, push it to its goal.

It depends on nothing but the answers of a `World`: the same answers lead to the same motions, so that a mission which
was interrupted goes on from the journal of what it was answered before.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from math import degrees, radians
from typing import Final, Literal, Protocol

from msgspec.structs import replace

from agent_proc.box_path import BoxPath
from agent_proc.box_path import stages as path_stages
from agent_proc.follower import Ending, Follower
from agent_proc.policy import Policy
from agent_proc.poses import BoxError, box_error, box_tilt_rad, distance_m, planar_pose
from agent_proc.push_estimate import PushEstimate
from agent_proc.routes import query_for_box, query_to_measured_box, query_to_nominal_box
from agent_proc.station import at_station, last_stretch, way_back
from legpush.errors import PeerError
from legpush.faces import FACES, PUSHABLE, pushed_box, pushed_pose
from legpush.geometry import Pose2, wrap_angle
from legpush.messages import Follow, Motion, Outcome, Plan, PlanQuery, Reset, Walk, WorldState
from legpush.robot import FOOT_RECTANGLE_RADIUS_M
from legpush.scenario import Face, Goal, Scenario

STILL_CYCLES: Final = 5
"""The robot is stuck when this many cycles in a row change too little."""
LEAST_WALK_M: Final = 0.02
"""That is: the trunk, or its place on the path, moved less than this in all of them."""
LEAST_PUSH_M: Final = 0.005
"""Or the box did."""
LEAST_TURN_RAD: Final = radians(0.5)
"""The same for its heading."""
MAX_STAGES: Final = 20
"""Paths of the box that are begun at most."""
AIM_M: Final = 0.02
AIM_DEG: Final = 2.0
MAX_BETTER: Final = 2
"""A box that is within its tolerances, but not within these, is pushed on so many times at most."""
MAX_BOX_TILT_RAD: Final = radians(15.0)
"""A box that leans farther is tipping over, or has."""

Reason = Literal[
    "success", "fell", "box_tipped", "no_path", "stuck", "missed_station", "max_push_cycles", "tolerance_missed"
]


class World(Protocol):
    """All that the mission can do and learn."""

    def step(self, motion: Motion) -> Outcome:
        """Carry out one motion."""

    def plan(self, query: PlanQuery) -> Plan:
        """Ask the planner."""

    def tell(self, phase: str, fraction: float | None, detail: str) -> None:
        """Let people know what goes on."""


@dataclass(frozen=True, kw_only=True)
class MissionResult:
    """How a mission ended."""

    success: bool
    """The box is within the tolerances of its goal and the robot stands."""
    reason: Reason
    """`success`, or what ended it without: the robot `fell` or is `stuck`, the `box_tipped` over, the planner knew
    `no_path`, the approach `missed_station`, `max_push_cycles` were not enough, or the policy stopped with the
    `tolerance_missed`."""
    detail: str
    """One sentence for people."""
    handover_distance_m: float | None
    """Trunk to box where walking along the map ended; None if it did not come to that."""
    n_push_cycles: int


def run_mission(world: World, scenario: Scenario, seed: int, policy: Policy) -> MissionResult:
    """Run a mission from its reset to its end."""
    return _Mission(world, scenario, seed, policy).run()


class _EndedError(Exception):
    """The mission is over, for this reason."""

    def __init__(self, reason: Reason, detail: str) -> None:
        super().__init__(detail)
        self.reason: Reason = reason


class _Mission:
    """A mission on its way; `_state` is the last one that the world was in."""

    _state: WorldState

    def __init__(self, world: World, scenario: Scenario, seed: int, policy: Policy) -> None:
        self._world = world
        self._scenario = scenario
        self._seed = seed
        self._policy = policy
        self._handover_distance_m: float | None = None
        self._n_push_cycles = 0
        self._estimates = {face: PushEstimate(pushed_box(scenario.box, face)) for face in FACES}
        """What pushes at each face do."""

    def run(self) -> MissionResult:
        """The step order of Fig. 5."""
        try:
            self._step(Reset(scenario=self._scenario, seed=self._seed))
            if self._standing_at() is None:
                self._walk_to_handover()
            self._handover_distance_m = self._box_distance_m()
            self._push()
        except _EndedError as end:
            success, reason, detail = False, end.reason, str(end)
        else:
            success, reason, detail = True, "success", f"box error {self._box_error()}"
        return MissionResult(
            success=success,
            reason=reason,
            detail=detail,
            handover_distance_m=self._handover_distance_m,
            n_push_cycles=self._n_push_cycles,
        )

    def _walk_to_handover(self) -> None:
        """Walk towards the nominal box until the real one is near enough to be measured, or the path ends."""
        near_m = self._scenario.mission.handover_distance_m
        if self._box_distance_m() > near_m:
            nominal = self._scenario.box.pose.pose()

            def way(face: Face) -> PlanQuery:
                return query_to_nominal_box(self._scenario, self._seed, self._trunk(), face)

            _, plan = self._way_to_push(nominal, way, "the way to the box")
            if plan is not None:
                self._walk("walking", plan.waypoints, until_m=near_m)

    def _push(self) -> None:
        """Push stage after stage along the path of the box; after each stage, and off the path, plan anew.

        A box within the tolerances is pushed on, a few times at most, until it is within `AIM` as well.
        """
        n_good = 0
        for _ in range(MAX_STAGES):
            before = self._box_error()
            n_good += before.within(self._scenario.goal)
            if before.within(self._aim()) or n_good > MAX_BETTER:
                return None
            stages = self._come_to_push()
            if self._scenario.pushing.composition == "open_loop":
                return self._push_blindly(stages)
            ending = self._follow(stages[0])
            error = self._box_error()
            if ending == "done" and len(stages) == 1 and not n_good and not _is_better(error, before):
                return self._require_goal("tolerance_missed", f"pushing ended at box error {error}")
        return self._require_goal("tolerance_missed", f"box error {self._box_error()} after {MAX_STAGES} paths")

    def _push_blindly(self, stages: list[BoxPath]) -> None:
        """All stages as they were planned, whatever comes of it."""
        for path in stages:
            if not self._at_station(path.face):
                self._approach(path.face)
            self._follow(path)
        self._require_goal("tolerance_missed", f"the open loop ended at box error {self._box_error()}")

    def _come_to_push(self) -> list[BoxPath]:
        """Plan the path of the box and walk to the face where it begins."""

        def way(face: Face) -> PlanQuery:
            return query_to_measured_box(self._scenario, self._seed, self._trunk(), self._box(), face)

        stages, plan = self._way_to_push(self._box(), way, "the way behind the box")
        face = stages[0].face
        if plan is not None:
            self._walk_behind(face, plan)
        return stages

    def _back_off(self) -> None:
        """From the box, straight back, so far that the robot can turn."""
        if self._standing_at() is None:
            return
        self._walk("backing off", way_back(self._scenario, self._trunk(), self._box()))

    def _way_to_push(
        self, box: Pose2, query: Callable[[Face], PlanQuery], what: str
    ) -> tuple[list[BoxPath], Plan | None]:
        """The path of a box, and the robot's way to its first face if it does not stand there: of those paths whose
        first face can be reached, the planner's favourite.
        """
        faces = self._faces()
        while True:
            stages = self._box_stages(box, faces)
            first = stages[0].face
            if self._at_station(first):
                return stages, None
            self._back_off()
            plan = self._ask(query(first), what)
            if plan.status == "exact":
                return stages, plan
            faces = tuple(face for face in faces if face != first)
            if not faces:
                raise _EndedError("no_path", f"{what}: the planner's answer is {plan.status}: {plan.reason}")

    def _box_stages(self, box: Pose2, faces: tuple[Face, ...]) -> list[BoxPath]:
        """The planned path of the box; with the least clearance where it has come closer to something than planned."""
        present = self._standing_at()
        estimates = {face: self._estimates[face] for face in faces}
        query = query_for_box(self._scenario, self._seed, box, estimates, present)
        plan = self._ask(query, "the path of the box")
        if plan.status == "invalid" and self._n_push_cycles and query.clearance_m > 0.0:
            plan = self._ask(replace(query, clearance_m=0.0), "the path of the box, closer to obstacles")
        if plan.status != "exact":
            raise _EndedError("no_path", f"the path of the box: the planner's answer is {plan.status}: {plan.reason}")
        return path_stages(plan, {face: estimate.axle_m for face, estimate in estimates.items()})

    def _aim(self) -> Goal:
        """The goal with tolerances no wider than the aim."""
        goal = self._scenario.goal
        return replace(
            goal,
            position_tolerance_m=min(goal.position_tolerance_m, AIM_M),
            angle_tolerance_deg=min(goal.angle_tolerance_deg, AIM_DEG),
        )

    def _faces(self) -> tuple[Face, ...]:
        """Those that can be pushed and may be."""
        return tuple(face for face in self._scenario.pushing.faces if face in PUSHABLE[self._scenario.box.shape])

    def _approach(self, face: Face) -> None:
        """Walk to the stand-off behind a face of the measured box, and straight on to the station."""
        query = query_to_measured_box(self._scenario, self._seed, self._trunk(), self._box(), face)
        plan = self._ask(query, "the way behind the box")
        if plan.status != "exact":
            raise _EndedError(
                "no_path", f"the way behind the box: the planner's answer is {plan.status}: {plan.reason}"
            )
        self._walk_behind(face, plan)

    def _walk_behind(self, face: Face, plan: Plan) -> None:
        """Along the path to the stand-off, and on to the station."""
        box, pose = pushed_box(self._scenario.box, face), pushed_pose(self._box(), face)
        self._walk("approaching", plan.waypoints + last_stretch(self._scenario, box, pose))
        if not self._at_station(face):
            raise _EndedError(
                "missed_station", f"the approach ended {self._box_distance_m():.2f} m from the box, not at the station"
            )

    def _follow(self, path: BoxPath) -> Ending:
        """Push along a stage of the path until it ends or the box has left it."""
        max_cycles = self._scenario.mission.max_push_cycles
        first_error_m = self._box_error().position_m
        estimate = self._estimates[path.face]
        follower = Follower(path, self._policy, self._scenario, estimate)
        boxes = deque([self._box()], STILL_CYCLES + 1)
        while True:
            error = self._box_error()
            done = max(0.0, 1.0 - error.position_m / first_error_m) if first_error_m > 0.0 else None
            self._world.tell("pushing", done, f"cycle {self._n_push_cycles}, box error {error}")
            decision = follower.decide(self._state)
            if decision.push is None:
                return decision.ending or "done"
            if self._n_push_cycles == max_cycles:
                self._require_goal("max_push_cycles", f"box error {error} after {max_cycles} push cycles")
                return "done"
            if not self._at_station(path.face):
                self._approach(path.face)
            self._n_push_cycles += 1
            before = pushed_pose(self._box(), path.face)
            self._step(decision.push)
            estimate.learn(before, decision.push, pushed_pose(self._box(), path.face))
            boxes.append(self._box())
            if len(boxes) > STILL_CYCLES and _moved_m(boxes[0], boxes[-1]) < LEAST_PUSH_M:
                self._require_goal("stuck", f"the box did not move in {STILL_CYCLES} push cycles, box error {error}")
                return "done"

    def _require_goal(self, reason: Reason, detail: str) -> None:
        """End the mission unless the box is where it should be."""
        if not self._box_error().within(self._scenario.goal):
            raise _EndedError(reason, detail)

    def _walk(self, phase: str, waypoints: tuple[Pose2, ...], until_m: float = 0.0) -> None:
        """Gait cycle by gait cycle to the end of the path, or until the box is nearer than `until_m`."""
        self._step(Follow(waypoints=waypoints))
        past: deque[tuple[Pose2, float]] = deque(maxlen=STILL_CYCLES + 1)
        while True:
            path = self._state.path
            if path is None:
                raise PeerError(f"Expected `path` in the state of the world at tick {self._state.tick}, got none")
            share = min(path.travelled_m / path.length_m, 1.0) if path.length_m > 0.0 else 1.0
            self._world.tell(phase, share, f"{path.travelled_m:.1f} of {path.length_m:.1f} m")
            if path.done or self._box_distance_m() <= until_m:
                return
            past.append((self._trunk(), path.travelled_m))
            (then, then_m), (now, now_m) = past[0], past[-1]
            if len(past) > STILL_CYCLES and min(_moved_m(then, now), now_m - then_m) < LEAST_WALK_M:
                raise _EndedError(
                    "stuck", f"no progress in {STILL_CYCLES} gait cycles, {share:.0%} of the path behind it"
                )
            self._step(Walk())

    def _ask(self, query: PlanQuery, what: str) -> Plan:
        """The planner's answer, whatever it is."""
        self._world.tell("planning", None, what)
        return self._world.plan(query)

    def _step(self, motion: Motion) -> None:
        """Move; a fall, of robot or box, ends the mission."""
        self._state = self._world.step(motion).world
        if self._state.fallen:
            raise _EndedError("fell", f"the robot fell during {type(motion).__name__.lower()}, tick {self._state.tick}")
        if (tilt_rad := box_tilt_rad(self._state)) > MAX_BOX_TILT_RAD:
            raise _EndedError("box_tipped", f"the box leans by {degrees(tilt_rad):.0f}° at tick {self._state.tick}")

    def _trunk(self) -> Pose2:
        return planar_pose(self._state.trunk)

    def _box(self) -> Pose2:
        return planar_pose(self._state.box)

    def _box_distance_m(self) -> float:
        return distance_m(self._trunk(), self._box())

    def _box_error(self) -> BoxError:
        return box_error(self._state, self._scenario)

    def _at_station(self, face: Face) -> bool:
        box = self._scenario.box
        return at_station(self._trunk(), pushed_box(box, face), pushed_pose(self._box(), face))

    def _standing_at(self) -> Face | None:
        """The face that the robot can push as it stands."""
        return next((face for face in self._faces() if self._at_station(face)), None)


def _is_better(error: BoxError, before: BoxError) -> bool:
    """Whether pushing has brought the box nearer to its goal pose by more than chance would."""
    return error.position_m < before.position_m - LEAST_PUSH_M or error.angle_rad < before.angle_rad - LEAST_TURN_RAD


def _moved_m(a: Pose2, b: Pose2) -> float:
    """Between two poses, turning counted by the arc of the foot rectangle's corners."""
    return distance_m(a, b) + abs(wrap_angle(b.yaw_rad - a.yaw_rad)) * FOOT_RECTANGLE_RADIUS_M
