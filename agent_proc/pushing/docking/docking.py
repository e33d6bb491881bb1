"""Brings a box that is near its goal there, move by move. Each move is chosen from the present pose of the box."""

from math import radians
from typing import Final

from agent_proc.pushing.docking.moves import DockMove, DockPush, dock_pushes
from agent_proc.pushing.docking.search import AREA_M, DockSearch
from agent_proc.pushing.docking.space import DockSpace
from agent_proc.pushing.follower import LAST_LEFT_M, LAST_TURN_RAD
from agent_proc.pushing.pushes import Pushes
from agent_proc.walking.actor import Actor
from agent_proc.walking.walker import Walker
from legpush.messages.stepping import Push
from legpush.scene.faces import pushed_pose
from legpush.scene.names import Face
from legpush.scene.scenario import Goal

DOCK_RAD: Final = radians(35.0)
"""A box that is turned farther from its goal is not near it."""
AIM_SHARE: Final = 0.3
"""Share of the aim's tolerances that a sequence of moves has to end within: pushes scatter, and short ones cost little.
"""
MAX_MOVES: Final = 40
"""Most moves of one docking."""


class Docking:
    """Chooses and carries out the moves of a mission near its goal."""

    def __init__(self, actor: Actor, walker: Walker, pushes: Pushes) -> None:
        self._actor = actor
        self._walker = walker
        self._pushes = pushes
        self._space: DockSpace | None = None

    def is_due(self) -> bool:
        """Return whether the box is near its goal, but not straight ahead of it, where a path is as quick."""
        if self._actor.scenario.pushing.composition == "open_loop":
            return False
        return self._is_near() and not any(self._is_straight(face) for face in self._pushes.estimates)

    def run(self, aim: Goal) -> bool:
        """Push a box that is near its goal until it is within `aim`; return whether nothing is left to do.

        If the push cycles are used up, being within the tolerances of the goal is enough.

        Raises:
            MissionEndedError: The push cycles are used up, or what a motion raises.
        """
        unreachable: set[Face] = set()
        self._space = None
        for n_done in range(MAX_MOVES):
            error = self._actor.box_error()
            if not self._is_near():
                return False
            moves = self._moves(aim, unreachable)
            if not moves or (error.within(aim) and not all(isinstance(move, DockPush) for move in moves)):
                return error.within(aim)
            move, n_cycles = moves[0], self._pushes.n_cycles
            self._actor.tell("pushing", None, f"cycle {n_cycles}, box error {error}, {len(moves)} moves to its goal")
            n_pushes = sum(isinstance(each, DockPush) for each in moves)
            if n_done == 0:
                self._pushes.budget.take(n_pushes, n_cycles)
            if isinstance(move, DockPush):
                if n_cycles >= self._pushes.budget.n_cycles:
                    if error.within(self._actor.scenario.goal):
                        return True
                    raise self._pushes.budget.used_up(n_pushes, f"box error {error}", f"{n_pushes} pushes are left")
                self._push(move)
            elif not self._walker.change_face(move.face):
                unreachable.add(move.face)
        return self._actor.box_error().within(aim)

    def _is_near(self) -> bool:
        error = self._actor.box_error()
        return error.position_m <= self._actor.scenario.pushing.docking_m and error.angle_rad <= DOCK_RAD

    def _is_straight(self, face: Face) -> bool:
        """Whether the goal is straight ahead of a box that is pushed at a face."""
        ahead = pushed_pose(self._actor.box(), face).inverse() @ pushed_pose(
            self._actor.scenario.goal.pose.pose(), face
        )
        return ahead.x_m > 0.0 and abs(ahead.y_m) <= LAST_LEFT_M and abs(ahead.yaw_rad) <= LAST_TURN_RAD

    def _moves(self, aim: Goal, unreachable: set[Face]) -> tuple[DockMove, ...]:
        """The quickest sequence of moves to the goal; empty if none was found."""
        actor = self._actor
        scenario, box, present = actor.scenario, actor.box(), actor.standing_at()
        estimates = {
            face: estimate
            for face, estimate in self._pushes.estimates.items()
            if face == present or face not in unreachable
        }
        search = DockSearch(
            dock_pushes(estimates),
            AIM_SHARE * aim.position_tolerance_m,
            AIM_SHARE * radians(aim.angle_tolerance_deg),
        )
        if self._space is None or self._space.room != scenario.room:
            self._space = DockSpace(scenario, box, AREA_M)
        return search.find(scenario.goal.pose.pose().inverse() @ box, present, self._space.is_free) or ()

    def _push(self, move: DockPush) -> None:
        w1, w2 = self._pushes.estimates[move.face].curve
        self._pushes.push(Push(w1=w1, w2=w2, leg=move.leg, depth_m=move.depth_m, face=move.face), learn=True)
