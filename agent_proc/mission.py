"""The mission (Fig. 5): plan, walk to the box, hand over, approach it, push it to its goal.

It depends on nothing but the answers of a `World`: the same answers lead to the same motions, so that a mission which
was interrupted goes on from the journal of what it was answered before.
"""

from collections import deque
from dataclasses import dataclass
from math import degrees, radians
from typing import Final, Literal, Protocol

from agent_proc.policy import Policy
from agent_proc.poses import BoxError, box_error, box_tilt_rad, distance_m, planar_pose
from agent_proc.routes import query_to_measured_box, query_to_nominal_box
from agent_proc.station import at_station, last_stretch
from legpush.errors import PeerError
from legpush.geometry import Pose2, wrap_angle
from legpush.messages import Follow, Motion, Outcome, Plan, PlanQuery, Reset, Walk, WorldState
from legpush.robot import FOOT_RECTANGLE_RADIUS_M
from legpush.scenario import Scenario

STILL_CYCLES: Final = 5
"""The robot is stuck when this many cycles in a row change too little."""
LEAST_WALK_M: Final = 0.02
"""That is: the trunk, or its place on the path, moved less than this in all of them."""
LEAST_PUSH_M: Final = 0.005
"""Or the box did."""
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

    def run(self) -> MissionResult:
        """The step order of Fig. 5."""
        try:
            self._step(Reset(scenario=self._scenario, seed=self._seed))
            if not self._at_station():
                self._walk_to_handover()
            self._handover_distance_m = self._box_distance_m()
            if not self._at_station():
                self._approach()
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
            plan = self._plan(query_to_nominal_box(self._scenario, self._seed, self._trunk()), "the way to the box")
            self._walk("walking", plan.waypoints, until_m=near_m)

    def _approach(self) -> None:
        """Walk to the stand-off behind the measured box, and straight on to the station."""
        query = query_to_measured_box(self._scenario, self._seed, self._trunk(), self._box())
        plan = self._plan(query, "the way behind the box")
        self._walk("approaching", plan.waypoints + last_stretch(self._scenario, self._box()))
        if not self._at_station():
            raise _EndedError(
                "missed_station", f"the approach ended {self._box_distance_m():.2f} m from the box, not at the station"
            )

    def _push(self) -> None:
        """Push as the policy says, until it is done or not allowed to go on."""
        max_cycles = self._scenario.mission.max_push_cycles
        first_error_m = self._box_error().position_m
        boxes = deque([self._box()], STILL_CYCLES + 1)
        while True:
            error = self._box_error()
            done = max(0.0, 1.0 - error.position_m / first_error_m) if first_error_m > 0.0 else None
            self._world.tell("pushing", done, f"cycle {self._n_push_cycles}, box error {error}")
            push = self._policy.decide(self._state, self._scenario)
            if push is None:
                return self._require_goal("tolerance_missed", f"the policy stopped at box error {error}")
            if self._n_push_cycles == max_cycles:
                return self._require_goal("max_push_cycles", f"box error {error} after {max_cycles} push cycles")
            if not self._at_station():
                self._approach()
            self._n_push_cycles += 1
            self._step(push)
            boxes.append(self._box())
            if len(boxes) > STILL_CYCLES and _moved_m(boxes[0], boxes[-1]) < LEAST_PUSH_M:
                return self._require_goal(
                    "stuck", f"the box did not move in {STILL_CYCLES} push cycles, box error {error}"
                )

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

    def _plan(self, query: PlanQuery, what: str) -> Plan:
        """A plan that leads to the goal; any other one ends the mission."""
        self._world.tell("planning", None, what)
        plan = self._world.plan(query)
        if plan.status != "exact":
            raise _EndedError("no_path", f"{what}: the planner's answer is {plan.status}: {plan.reason}")
        return plan

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

    def _at_station(self) -> bool:
        return at_station(self._trunk(), self._scenario.box, self._box())


def _moved_m(a: Pose2, b: Pose2) -> float:
    """Between two poses, turning counted by the arc of the foot rectangle's corners."""
    return distance_m(a, b) + abs(wrap_angle(b.yaw_rad - a.yaw_rad)) * FOOT_RECTANGLE_RADIUS_M
