"""Walks along a path, behind a face of the box, and back from it."""

from collections import deque
from typing import Final

import numpy as np

from agent_proc.endings import MissionEndedError
from agent_proc.walking.actor import Actor
from agent_proc.walking.obstacles import has_clearance, is_in_walk
from agent_proc.walking.route_planner import RoutePlanner
from agent_proc.walking.stuck import STILL_CYCLES, THROWN_CYCLES, is_stuck
from legpush.errors import BadAnswerError
from legpush.geometry import Pose2, distance_m
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Follow, PathProgress, Walk
from legpush.plans.trunk_queries import query_to_measured_box, query_to_nominal_box
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.paths import distances_m
from legpush.scene.station import can_turn, last_stretch, station, way_back

THROWN_M: Final = 0.25
"""A robot that is farther from its planned path was thrown off it, as by a gust. Otherwise it tracks a path to 3 cm
(RMS)."""
MOST_THROWN: Final = 50
"""How often a mission plans again for that."""


class Walker:
    """Walks, gait cycle by gait cycle, and takes better paths as the planner finds them."""

    def __init__(self, actor: Actor, planner: RoutePlanner) -> None:
        self._actor = actor
        self._planner = planner
        self._n_thrown = 0
        self._is_thrown = False
        """Whether the last walk ended as the robot was thrown off its path."""

    def walk_plan(self, phase: str, plan: Plan, *, last_stretch: tuple[Pose2, ...] = (), until_m: float = 0.0) -> bool:
        """Walk along the last plan that was asked for and on along `last_stretch`, as `walk` does.

        Returns False also if the robot was thrown off the path.
        """
        done = self.walk(phase, plan.waypoints + last_stretch, until_m, last_stretch, is_planned=True)
        self._planner.cancel()
        return done

    def walk(
        self,
        phase: str,
        waypoints: tuple[Pose2, ...],
        until_m: float = 0.0,
        last_stretch: tuple[Pose2, ...] = (),
        *,
        is_planned: bool = False,
    ) -> bool:
        """Walk to the end of a path, or until the box is nearer than `until_m`.

        Returns False if an obstacle has appeared in what is left of the path. `last_stretch` is the part at the end of
        the path that a better path has to end with.

        Raises:
            MissionEndedError: The robot is stuck, or what a motion raises.
            BadAnswerError: The world reports no progress on the path.
        """
        self._actor.step(Follow(waypoints=waypoints))
        self._is_thrown = False
        n_known = self._actor.n_appeared()
        past: deque[tuple[Pose2, float]] = deque(maxlen=THROWN_CYCLES + 1)
        while True:
            path = self._progress()
            share = min(path.travelled_m / path.length_m, 1.0) if path.length_m > 0.0 else 1.0
            self._actor.tell(phase, share, f"{path.travelled_m:.1f} of {path.length_m:.1f} m")
            if path.done or self._actor.box_distance_m() <= until_m:
                return True
            new = self._actor.appeared_since(n_known)
            if any(is_in_walk(each, self._actor.scenario, waypoints, path.travelled_m) for each in new):
                self._planner.give_up("the robot", n_known)
                return False
            if new:
                self._planner.forget_better_paths()
            n_known = self._actor.n_appeared()
            if is_planned and self._is_thrown_off(waypoints):
                return False
            if better := self._planner.better_path(waypoints, path.travelled_m, last_stretch):
                waypoints = better
                self._actor.step(Follow(waypoints=waypoints))
                past.clear()
                continue
            past.append((self._actor.trunk(), path.travelled_m))
            if is_stuck(past, self._actor.scenario.robot.stance.foot_circle_m):
                raise MissionEndedError(
                    "stuck",
                    f"no progress in at least {STILL_CYCLES} gait cycles, {share:.0%} of the path behind it",
                    "raise `planning.margin_m`, so that paths keep away from what holds the robot",
                )
            self._actor.step(Walk())

    def _is_thrown_off(self, waypoints: tuple[Pose2, ...]) -> bool:
        """Whether the robot is so far from its path that another one is better; too near to something, there is none.

        Raises:
            MissionEndedError: That was so too often.
        """
        actor, trunk = self._actor, self._actor.trunk()
        off_m = float(distances_m(trunk.xy()[None], np.array([pose.xy() for pose in waypoints]))[0])
        self._is_thrown = off_m > THROWN_M and has_clearance(actor.scenario, trunk, actor.box())
        if not self._is_thrown:
            return False
        self._n_thrown += 1
        if self._n_thrown > MOST_THROWN:
            raise MissionEndedError(
                "stuck",
                f"the robot was thrown off its path more than {MOST_THROWN} times",
                "lower the force of `realism.gusts`, or raise the time between them",
            )
        self._planner.start_over(off_m)
        return True

    def query_behind_nominal(self, face: Face) -> PlanQuery:
        """Query for the way from here to behind a face of the box at its nominal pose, wherever the box really is."""
        return query_to_nominal_box(self._actor.scenario, self._planner.seed, self._actor.trunk(), face)

    def query_behind(self, face: Face) -> PlanQuery:
        """Query for the way from here to the stand-off behind a face of the measured box."""
        actor = self._actor
        return query_to_measured_box(actor.scenario, self._planner.seed, actor.trunk(), actor.box(), face)

    def walk_behind(self, face: Face, plan: Plan) -> bool:
        """Walk along the planned path to the stand-off behind a face, and on to the station.

        Returns False if an obstacle has appeared in the way, where the robot then has space to turn, or if it was
        thrown off the way.

        Raises:
            MissionEndedError: The walk ended, but not at the station.
        """
        scenario, box = self._actor.scenario, self._actor.box()
        stretch = last_stretch(scenario, pushed_box(scenario.box, face), pushed_pose(box, face))
        if not self.walk_plan("approaching", plan, last_stretch=stretch):
            is_free = can_turn(self._actor.scenario, self._actor.trunk(), self._actor.box())
            if not (self._is_thrown or is_free):
                self._walk_back()
            return False
        if not self._actor.at_station(face):
            raise self._missed(box)
        return True

    def _missed(self, box: Pose2) -> MissionEndedError:
        """The error of an approach that ended beside the station; `box` is where the box was before."""
        ended = f"the approach ended {self._actor.box_distance_m():.2f} m from the box"
        moved_m = distance_m(box, self._actor.box())
        if moved_m <= self._actor.scenario.robot.pushing.at_station_m:
            return MissionEndedError("missed_station", f"{ended}, not at the station")
        return MissionEndedError(
            "missed_station",
            f"{ended}, which moved by {moved_m:.2f} m meanwhile",
            "raise `box.friction` or lower `room.slope_deg`, so that the box stays where it is",
        )

    def approach(self, face: Face) -> None:
        """Walk to the station behind a face of the measured box.

        Raises:
            MissionEndedError: There is no path.
        """
        while True:
            query = self.query_behind(face)
            plan = self._planner.ask(query, "the way behind the box")
            if plan.status != "exact":
                raise self._planner.no_path("the way behind the box", query, plan)
            if self.walk_behind(face, plan):
                return

    def step_to_station(self, face: Face) -> None:
        """Step straight to the station behind a face of the box as it is seen now, from a place that is near it.

        Raises:
            MissionEndedError: What a motion raises.
        """
        scenario = self._actor.scenario
        place = station(scenario.robot, pushed_box(scenario.box, face), pushed_pose(self._actor.box(), face))
        self.walk("approaching", (self._actor.trunk(), place))

    def change_face(self, face: Face) -> bool:
        """Walk around the box to the station behind another face; returns whether the robot came there."""
        self.back_off()
        plan = self._planner.ask(self.query_behind(face), "the way to another face of the box")
        return plan.status == "exact" and self.walk_behind(face, plan)

    def back_off(self) -> None:
        """Walk straight back from the box, if the robot stands at a station, until it has space to turn."""
        if self._actor.standing_at() is not None:
            self._walk_back()

    def _walk_back(self) -> None:
        self.walk("backing off", way_back(self._actor.scenario, self._actor.trunk(), self._actor.box()))

    def _progress(self) -> PathProgress:
        state = self._actor.state
        if state.path is None:
            raise BadAnswerError(f"Expected `path` in the state of the world at tick {state.tick}, got none")
        return state.path
