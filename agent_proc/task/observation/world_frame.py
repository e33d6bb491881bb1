"""What the paper observes (Eq. 19), in the world frame, and the foot forces that its code observes instead of feet.

Tracked corners of the box are 1, front left, and 2, front right, at its upper edge: the side that leads.
"""

from typing import ClassVar, Final, Literal

import numpy as np

from agent_proc.frames.corners import tracked_corners_m
from agent_proc.frames.push_view import PushView
from agent_proc.task.term import ObservationTerm
from legpush.arrays import Floats
from legpush.messages.stepping import BoxState
from legpush.scene.conventions import LEGS
from legpush.scene.scenario import Scenario

Corner = Literal[1, 2]
Leg = Literal["FL", "FR", "RL", "RR"]
SIDES: Final = {1: "left", 2: "right"}
LARGEST_FORCE_N: Final = 1000.0
"""Three times the robot's weight on one foot."""


class Body(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Place of the robot's trunk."""

    def meaning(self) -> str:
        """What the elements are."""
        return "trunk centre"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The place, (3,)."""
        return np.array(view.world.trunk.position_m)


class BoxCorner(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Place of a tracked corner of the box."""

    corner: Corner
    """1: front left, 2: front right."""
    frozen: bool = False
    """Whether it is read at the nominal pose of the box in the scenario. The published code reads it at the reset,
    where its box always stands there, and never again."""

    def meaning(self) -> str:
        """What the elements are."""
        where = ", where the scenario puts it" if self.frozen else ""
        return f"front {SIDES[self.corner]} upper corner of the box{where}"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The place, (3,)."""
        corners = _nominal_corners_m(view.scenario) if self.frozen else view.corners_w_m
        place: Floats = corners[self.corner - 1]
        return place


class Tip(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Place of a foot."""

    leg: Leg
    """FL, FR, RL or RR."""

    def meaning(self) -> str:
        """What the elements are."""
        return f"centre of the foot sphere of {self.leg}"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The place, (3,)."""
        return np.array(view.world.tips_m[LEGS.index(self.leg)])


class FootForces(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Contact forces of the feet."""

    AXES: ClassVar[tuple[str, ...]] = LEGS
    UNIT: ClassVar[str] = "N"
    FRAME: ClassVar[str] = ""

    by_largest: bool = False
    """Whether they are divided by the largest of them, as in the published code."""

    def meaning(self) -> str:
        """What the elements are."""
        return f"contact force of each foot{', over the largest of the four' if self.by_largest else ''}"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The forces, (4,); zeros stay zeros."""
        forces = np.clip(np.array(view.world.foot_forces_n), 0.0, LARGEST_FORCE_N)
        largest = float(forces.max())
        shares: Floats = forces / (largest if self.by_largest and largest > 0.0 else 1.0)
        return shares

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """From none to three times the robot's weight, or to 1."""
        return np.zeros(4), np.full(4, 1.0 if self.by_largest else LARGEST_FORCE_N)


class GoalCorner(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Place where a tracked corner has to be, on the floor."""

    AXES: ClassVar[tuple[str, ...]] = ("x", "y")

    corner: Corner
    """1: front left, 2: front right."""

    def meaning(self) -> str:
        """What the elements are."""
        return f"where corner {self.corner} has to be"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The place, (2,)."""
        place: Floats = view.goal_corners_w_m[self.corner - 1]
        return place


def _nominal_corners_m(scenario: Scenario) -> Floats:
    """Tracked corners of the box at its nominal pose, world frame, (2, 3)."""
    box = scenario.box
    pose = box.pose.pose()
    half_rad = pose.yaw_rad / 2
    state = BoxState(
        position_m=(pose.x_m, pose.y_m, box.size_m[2] / 2),
        orientation_wxyz=(float(np.cos(half_rad)), 0.0, 0.0, float(np.sin(half_rad))),
    )
    return tracked_corners_m(state, box)
