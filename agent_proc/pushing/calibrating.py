"""Calibration pushes: some pushes straight ahead, so that paths are planned for the box as it is."""

from typing import Final

from agent_proc.pushing.pushes import Pushes
from agent_proc.pushing.queries import calibration_query
from agent_proc.walking.actor import Actor
from agent_proc.walking.route_planner import RoutePlanner
from legpush.geometry import distance_m
from legpush.messages.common import USUAL_DEPTH_M
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.names import Face

STRAIGHT_WITHIN_M: Final = 0.005
"""A path that is longer by more than this than its ends are apart is not straight."""
CALIBRATION_LEGS: Final = (0, 1, 1, 0)
"""0 is FL, 1 is FR: the box turns to and fro, and goes straight on in the mean."""


class Calibration:
    """Pushes with both legs in turn, from which the estimates learn before a path is planned with them."""

    def __init__(self, actor: Actor, planner: RoutePlanner, pushes: Pushes) -> None:
        self._actor = actor
        self._planner = planner
        self._pushes = pushes

    def run(self, face: Face) -> None:
        """Push at a face that the robot stands at, as often as the scenario says.

        It does not push if there is no space straight ahead, and stops once an obstacle appears.

        Raises:
            MissionEndedError: What a push raises.
        """
        scenario, estimate = self._actor.scenario, self._pushes.estimates[face]
        ahead = calibration_query(scenario, self._planner.seed, self._actor.box(), face, estimate)
        plan = self._planner.ask(ahead, "the way for the calibration")
        if plan.status != "exact" or plan.length_m > distance_m(ahead.start, ahead.goal) + STRAIGHT_WITHIN_M:
            return
        w1, w2 = estimate.curve
        n_pushes, n_known = scenario.pushing.calibration_pushes, self._actor.n_appeared()
        for index in range(min(n_pushes, scenario.mission.max_push_cycles or n_pushes)):
            if self._actor.n_appeared() > n_known:
                return
            self._actor.tell("calibrating", index / n_pushes, f"push {index + 1} of {n_pushes}, {face} face")
            leg = FRONT_LEGS[CALIBRATION_LEGS[index % len(CALIBRATION_LEGS)]]
            self._pushes.push(Push(w1=w1, w2=w2, leg=leg, depth_m=USUAL_DEPTH_M, face=face), learn=True)
