"""The box in the frame of its goal; in a mirror image, the box is always left of the line through the goal.

Where the leading edge of the box is right of the line, y and angles change their sign in the mirror image. What was
learned on one side holds on the other. The robot itself is not observed: every push cycle ends at the station. The
exact pose of trunk and feet reveals which leg pushed last. A policy that sees it learns to alternate legs, and fails
where the posture differs, for example on a slope.
"""

from math import degrees, pi, radians
from typing import Annotated, ClassVar, Final

import numpy as np
from msgspec import Meta

from agent_proc.frames.push_view import LOOK_AHEAD_M, PushView
from agent_proc.task.term import BEYOND_M, ObservationTerm
from legpush.arrays import Floats
from legpush.bounds import LEAST_ANGLE_DEG, MAX_TURN_DEG, Length
from legpush.scene.scenario import Scenario

NEAR_M: Final = 0.05
NEAR_DEG: Final = 1.0
FAR_M: Final = 1.0
NearAngle = Annotated[float, Meta(ge=LEAST_ANGLE_DEG, le=MAX_TURN_DEG)]


class BoxPlace(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Place of the box."""

    AXES: ClassVar[tuple[str, ...]] = ("x", "y")
    FRAME: ClassVar[str] = "goal"
    HAS_MIRROR_IMAGE: ClassVar[bool] = True

    far_m: Length = FAR_M
    """A box that is farther short of its goal is observed at this distance."""

    def meaning(self) -> str:
        """What the elements are."""
        return f"centre of the box; x is minus the distance that remains, {self.far_m:g} m at most"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The place, (2,)."""
        return np.array([max(view.box_g.x_m, -self.far_m), mirror_sign * view.box_g.y_m])

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """As far as the room is long, and a metre."""
        high = np.full(2, np.hypot(*scenario.room.size_m) + BEYOND_M)
        return -high, high


class BoxPlaceNear(BoxPlace, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Place of the box, with the last centimetres enlarged."""

    UNIT: ClassVar[str] = "1"

    near_m: Length = NEAR_M
    """From about this length on, the elements grow with the logarithm of a distance."""

    def meaning(self) -> str:
        """What the elements are."""
        return f"asinh of the same over {self.near_m:g} m: the last centimetres count most"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The values, (2,)."""
        near: Floats = np.arcsinh(super().read(view, mirror_sign) / self.near_m)
        return near

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """Those of the place, enlarged."""
        low, high = super().limits(scenario)
        return np.arcsinh(low / self.near_m), np.arcsinh(high / self.near_m)


class Heading(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Heading of the box, and its steering error."""

    AXES: ClassVar[tuple[str, ...]] = ("yaw", "steering")
    UNIT: ClassVar[str] = "rad"
    FRAME: ClassVar[str] = "goal"
    HAS_MIRROR_IMAGE: ClassVar[bool] = True

    def meaning(self) -> str:
        """What the elements are."""
        return f"heading of the box, and that less the one toward the goal's line {LOOK_AHEAD_M:g} m ahead"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The angles, (2,)."""
        return mirror_sign * np.array([view.box_g.yaw_rad, view.steering_error_rad])

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """Half a turn either way."""
        return np.full(2, -pi), np.full(2, pi)


class HeadingNear(Heading, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Heading and steering error, with the last degrees enlarged."""

    UNIT: ClassVar[str] = "1"

    near_deg: NearAngle = NEAR_DEG
    """From about this angle on, the elements grow with the logarithm of an angle."""

    def meaning(self) -> str:
        """What the elements are."""
        return f"asinh of the same over {degrees(radians(self.near_deg)):g}°"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The values, (2,)."""
        near: Floats = np.arcsinh(super().read(view, mirror_sign) / radians(self.near_deg))
        return near

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """Half a turn, enlarged."""
        high = np.full(2, float(np.arcsinh(pi / radians(self.near_deg))))
        return -high, high


class BoxYaw(Heading, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Heading of the box alone."""

    AXES: ClassVar[tuple[str, ...]] = ("yaw",)

    def meaning(self) -> str:
        """What the element is."""
        return "heading of the box"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The angle, (1,)."""
        return super().read(view, mirror_sign)[:1]

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """Half a turn either way."""
        return np.full(1, -pi), np.full(1, pi)
