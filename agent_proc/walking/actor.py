"""What a mission does in its world: walk, approach a face of the box, ask the planner, and know where everything is."""

from collections import deque
from collections.abc import Callable
from itertools import groupby
from math import degrees, radians
from typing import Final

from agent_proc.endings import MissionEndedError
from agent_proc.frames.poses import BoxError, box_error, box_tilt_rad
from agent_proc.walking.better_paths import BetterPaths
from agent_proc.walking.obstacles import in_words, is_in_walk, known_scenario
from legpush.errors import PeerError
from legpush.geometry import Pose2, distance_m
from legpush.lockstep.world import World
from legpush.messages.planning import Plan, PlanQuery, TrunkPathQuery
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Motion, Walk, WorldState
from legpush.plans.trunk_queries import query_to_measured_box
from legpush.runs.report import Reason
from legpush.scene.faces import PUSHABLE, pushed_box, pushed_pose
from legpush.scene.paths import path_length_m
from legpush.scene.scenario import Face, Rectangle, Scenario
from legpush.scene.station import at_station, can_turn, last_stretch, way_back

STILL_CYCLES: Final = 5
"""The robot is stuck when this many cycles in a row change too little."""
LEAST_WALK_M: Final = 0.02
"""That is: the trunk, or its place on the path, moved less than this in all of them."""
MAX_BOX_TILT_RAD: Final = radians(15.0)
"""A box that leans farther is tipping over, or has."""


Revise = Callable[[Scenario], Scenario]
Tell = Callable[[str, float | None, str], None]
"""Phase, share of it that is done if known, and a detail, for people."""


def as_it_is(scenario: Scenario) -> Scenario:
    """A scenario that stays the same."""
    return scenario


def nobody(_phase: str, _fraction: float | None, _detail: str) -> None:
    """Tell nobody."""


class Actor:
    """A robot with its box; `state` is the last one that the world was in."""

    state: WorldState

    def __init__(
        self, world: World, scenario: Scenario, seed: int, revise: Revise = as_it_is, tell: Tell = nobody
    ) -> None:
        """`revise` is asked after each step what the mission goes by from then on; `tell` gets its progress."""
        self.world = world
        self.tell = tell
        self._revise = revise
        self._whole = scenario
        self.scenario = scenario
        """As far as it is known: without the obstacles that have not appeared."""
        self.seed = seed
        self._better: BetterPaths | None = None
        """Of the last plan that was asked for."""
        self.n_better_paths = 0
        """How often a better path was taken."""
        self.n_replans = 0
        """How often an obstacle appeared in the way."""

    def walk_plan(self, phase: str, plan: Plan, *, last_stretch: tuple[Pose2, ...] = (), until_m: float = 0.0) -> bool:
        """Along the plan that was asked for last, and on, as `walk` does; better ones are taken as they come."""
        done = self.walk(phase, plan.waypoints + last_stretch, until_m, last_stretch)
        self._better = None
        self.world.cancel_plan()
        return done

    def walk(
        self, phase: str, waypoints: tuple[Pose2, ...], until_m: float = 0.0, last_stretch: tuple[Pose2, ...] = ()
    ) -> bool:
        """Gait cycle by gait cycle to the end of the path, or until the box is nearer than `until_m`; False where an
        obstacle has appeared in what is left of the way.
        """
        self.step(Follow(waypoints=waypoints))
        n_known = self.n_appeared()
        past: deque[tuple[Pose2, float]] = deque(maxlen=STILL_CYCLES + 1)
        while True:
            path = self.state.path
            if path is None:
                raise PeerError(f"Expected `path` in the state of the world at tick {self.state.tick}, got none")
            share = min(path.travelled_m / path.length_m, 1.0) if path.length_m > 0.0 else 1.0
            self.tell(phase, share, f"{path.travelled_m:.1f} of {path.length_m:.1f} m")
            if path.done or self.box_distance_m() <= until_m:
                return True
            if any(is_in_walk(new, self.scenario, waypoints, path.travelled_m) for new in self.appeared_since(n_known)):
                self.give_up("the robot", n_known)
                return False
            if self.n_appeared() > n_known:
                self._better = None
            n_known = self.n_appeared()
            if better := self._better_path(waypoints, path.travelled_m, last_stretch):
                waypoints = better
                self.step(Follow(waypoints=waypoints))
                past.clear()
                continue
            past.append((self.trunk(), path.travelled_m))
            (then, then_m), (now, now_m) = past[0], past[-1]
            if len(past) > STILL_CYCLES and min(path_length_m((then, now)), now_m - then_m) < LEAST_WALK_M:
                raise MissionEndedError(
                    "stuck", f"no progress in {STILL_CYCLES} gait cycles, {share:.0%} of the path behind it"
                )
            self.step(Walk())

    def _better_path(
        self, waypoints: tuple[Pose2, ...], travelled_m: float, last_stretch: tuple[Pose2, ...]
    ) -> tuple[Pose2, ...]:
        """A path from here on that is shorter than what is left of the present one, if the planner has found one; it is
        waited for before each gait cycle but the first, so that a mission can be repeated.
        """
        if self._better is None or travelled_m == 0.0 or (revision := self._better.next_revision()) is None:
            return ()
        left_m = path_length_m(waypoints) - travelled_m - path_length_m(last_stretch)
        plan = self.world.revision(revision)
        self._require_followable(self._better.query, plan, f"revision {revision} of the way")
        joined = self._better.joined(plan, self.trunk(), left_m)
        if joined:
            self.n_better_paths += 1
        return joined + last_stretch if joined else ()

    def query_behind(self, face: Face) -> PlanQuery:
        """For the way from here to the stand-off behind a face of the box where it is."""
        return query_to_measured_box(self.scenario, self.seed, self.trunk(), self.box(), face)

    def walk_behind(self, face: Face, plan: Plan) -> bool:
        """Along the path to the stand-off, and on to the station; False where an obstacle has appeared in the way, and
        then the robot has space to turn.
        """
        box, pose = pushed_box(self.scenario.box, face), pushed_pose(self.box(), face)
        if not self.walk_plan("approaching", plan, last_stretch=last_stretch(self.scenario, box, pose)):
            if not can_turn(self.scenario, self.trunk(), self.box()):
                self.walk("backing off", way_back(self.scenario, self.trunk(), self.box()))
            return False
        if not self.at_station(face):
            raise MissionEndedError(
                "missed_station", f"the approach ended {self.box_distance_m():.2f} m from the box, not at the station"
            )
        return True

    def approach(self, face: Face) -> None:
        """Walk to the stand-off behind a face of the measured box, and straight on to the station."""
        while True:
            plan = self.ask(self.query_behind(face), "the way behind the box")
            if plan.status != "exact":
                raise self.no_path("the way behind the box", plan)
            if self.walk_behind(face, plan):
                return

    def back_off(self) -> None:
        """From the box, straight back, so far that the robot can turn."""
        if self.standing_at() is None:
            return
        self.walk("backing off", way_back(self.scenario, self.trunk(), self.box()))

    def ask(self, query: PlanQuery, what: str) -> Plan:
        """The planner's answer, whatever it is; `PeerError` where it cannot be followed though it says so."""
        self.tell("planning", None, what)
        plan = self.world.plan(query)
        self._require_followable(query, plan, what)
        self._better = BetterPaths(query, plan) if isinstance(query, TrunkPathQuery) and query.anytime else None
        return plan

    @staticmethod
    def _require_followable(query: PlanQuery, plan: Plan, what: str) -> None:
        """`PeerError` where a plan cannot be followed though it says so."""
        if plan.status == "exact" and (fault := plan_fault(query, plan)):
            raise PeerError(f"{what}: expected a plan that can be followed, but {fault}")

    def no_path(self, what: str, plan: Plan) -> MissionEndedError:
        """What to raise where there is no way."""
        appeared = f"; appeared: {in_words(self.state.appeared)}" if self.state.appeared else ""
        return MissionEndedError("no_path", f"{what}: the planner's answer is {plan.status}: {plan.reason}{appeared}")

    def n_appeared(self) -> int:
        """How many obstacles have appeared up to now."""
        return len(self.state.appeared)

    def appeared_since(self, n_known: int) -> list[Rectangle]:
        """All that have appeared but the first `n_known`."""
        return [self._whole.room.obstacles[each.obstacle] for each in self.state.appeared[n_known:]]

    def give_up(self, what: str, n_known: int) -> None:
        """Count that a path of robot or box is given up, and say what has appeared beyond the first `n_known`."""
        self.n_replans += 1
        self.tell("giving up a path", None, f"of {what}; appeared: {in_words(self.state.appeared[n_known:])}")

    def step(self, motion: Motion) -> None:
        """Move, and look around; a fall, of robot or box, ends the mission."""
        self.state = self.world.step(motion, with_trace=True).world
        self.scenario = known_scenario(self._revise(self._whole), self.state)
        if self.state.fallen:
            raise MissionEndedError(
                "fell", f"the robot fell during {type(motion).__name__.lower()}, tick {self.state.tick}"
            )
        if (tilt_rad := box_tilt_rad(self.state)) > MAX_BOX_TILT_RAD:
            raise MissionEndedError(
                "box_tipped", f"the box leans by {degrees(tilt_rad):.0f}° at tick {self.state.tick}"
            )

    def require_goal(self, reason: Reason, detail: str) -> None:
        """End the mission unless the box is where it should be."""
        if not self.box_error().within(self.scenario.goal):
            raise MissionEndedError(reason, detail)

    def faces(self) -> tuple[Face, ...]:
        """Those that can be pushed and may be."""
        return tuple(face for face in self.scenario.pushing.faces if face in PUSHABLE[self.scenario.box.shape])

    def trunk(self) -> Pose2:
        """Where the robot is."""
        return planar_pose(self.state.trunk)

    def box(self) -> Pose2:
        """Where the box is."""
        return planar_pose(self.state.box)

    def box_distance_m(self) -> float:
        """From the trunk to the box."""
        return distance_m(self.trunk(), self.box())

    def box_error(self) -> BoxError:
        """How far the box is from its goal."""
        return box_error(self.state, self.scenario)

    def at_station(self, face: Face) -> bool:
        """Whether a face of the box can be pushed from where the robot stands."""
        box = self.scenario.box
        return at_station(self.trunk(), pushed_box(box, face), pushed_pose(self.box(), face))

    def standing_at(self) -> Face | None:
        """The face that the robot can push as it stands."""
        return next((face for face in self.faces() if self.at_station(face)), None)


def plan_fault(query: PlanQuery, plan: Plan) -> str:
    """Why an exact plan cannot be followed, or nothing: the planner may be anybody's."""
    if not plan.waypoints:
        return "it has no waypoints"
    if isinstance(query, TrunkPathQuery):
        return ""
    if len(plan.sides) != len(plan.waypoints):
        return f"it has {len(plan.waypoints)} waypoints and {len(plan.sides)} sides"
    if max(plan.sides) >= len(query.sides):
        return f"it names side {max(plan.sides)} of {len(query.sides)}"
    for _, stage in groupby(zip(plan.sides, plan.waypoints, strict=True), key=lambda item: item[0]):
        poses = [pose for _, pose in stage]
        if all(distance_m(pose, poses[0]) == 0.0 for pose in poses):
            return f"the box does not move in the stage at ({poses[0].x_m:g}, {poses[0].y_m:g})"
    return ""
