"""Carries out one motion after the other, and knows where everything is after each."""

from collections.abc import Callable
from math import degrees, radians
from typing import Final

from agent_proc.endings import MissionEndedError
from agent_proc.frames.poses import BoxError, box_error, box_tilt_rad
from agent_proc.walking.obstacles import known_scenario
from legpush.geometry import Pose2, distance_m
from legpush.lockstep.mission import Tell
from legpush.lockstep.world import SteppingWorld
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import Motion, WorldState
from legpush.runs.reasons import Reason
from legpush.scene.faces import PUSHABLE, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.scenario import Rectangle, Scenario
from legpush.scene.station import at_station

MAX_BOX_TILT_RAD: Final = radians(15.0)
"""A box that leans farther is tipping over, or has."""

Revise = Callable[[Scenario], Scenario]


def as_it_is(scenario: Scenario) -> Scenario:
    """Return the same scenario."""
    return scenario


def nobody(_phase: str, _fraction: float | None, _detail: str) -> None:
    """Tell nobody."""


class Actor:
    """A robot with its box, moved by one motion at a time."""

    state: WorldState
    """The world after the last motion as it is perceived: all that decisions depend on."""
    true_state: WorldState
    """The same as it is. It says what came out, and whether the robot fell."""

    def __init__(
        self, world: SteppingWorld, scenario: Scenario, revise: Revise = as_it_is, tell: Tell = nobody
    ) -> None:
        """`revise` returns the scenario that holds after a step; `tell` gets the progress of the mission."""
        self._world = world
        self.tell = tell
        self._revise = revise
        self._whole = scenario
        self.scenario = scenario
        """As it is known: without the obstacles that have not appeared."""

    def step(self, motion: Motion) -> None:
        """Carry out a motion, and look around.

        Raises:
            MissionEndedError: The robot fell, or the box is tipping over.
        """
        self.true_state = self._world.step(motion, with_trace=True).world
        self.state = as_seen(self.true_state)
        self.scenario = known_scenario(self._revise(self._whole), self.state)
        if self.true_state.fallen:
            raise MissionEndedError(
                "fell", f"the robot fell during {type(motion).__name__.lower()}, tick {self.state.tick}"
            )
        if (tilt_rad := box_tilt_rad(self.true_state)) > MAX_BOX_TILT_RAD:
            raise MissionEndedError(
                "box_tipped", f"the box leans by {degrees(tilt_rad):.0f}° at tick {self.state.tick}"
            )

    def require_goal(self, reason: Reason, detail: str) -> None:
        """Do nothing if the box is perceived at its goal.

        Raises:
            MissionEndedError: It is not.
        """
        if not self.box_error().within(self.scenario.goal):
            raise MissionEndedError(reason, detail)

    def n_appeared(self) -> int:
        """Number of obstacles that have appeared."""
        return len(self.state.appeared)

    def appeared_since(self, n_known: int) -> list[Rectangle]:
        """All obstacles that have appeared, but the first `n_known`."""
        return [self._whole.room.obstacles[each.obstacle] for each in self.state.appeared[n_known:]]

    def faces(self) -> tuple[Face, ...]:
        """Faces of the box that can be pushed and may be."""
        return tuple(face for face in self.scenario.pushing.faces if face in PUSHABLE[self.scenario.box.shape])

    def trunk(self) -> Pose2:
        """Where the robot takes itself to be."""
        return planar_pose(self.state.trunk)

    def box(self) -> Pose2:
        """Where the box is perceived."""
        return planar_pose(self.state.box)

    def box_distance_m(self) -> float:
        """From the trunk to the box."""
        return distance_m(self.trunk(), self.box())

    def box_error(self) -> BoxError:
        """How far the box is from its goal, as it is perceived."""
        return box_error(self.state, self.scenario)

    def true_box_error(self) -> BoxError:
        """How far the box is from its goal: what success is judged by."""
        return box_error(self.true_state, self.scenario)

    def at_station(self, face: Face) -> bool:
        """Whether a face of the box can be pushed from where the robot stands."""
        scenario = self.scenario
        box, pose = pushed_box(scenario.box, face), pushed_pose(self.box(), face)
        return at_station(scenario.robot, self.trunk(), box, pose)

    def standing_at(self) -> Face | None:
        """The face that the robot can push as it stands, if there is one."""
        return next((face for face in self.faces() if self.at_station(face)), None)
