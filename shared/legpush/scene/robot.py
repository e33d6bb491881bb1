"""The robot as one record: its body, how it stands and walks, and how it pushes.

The defaults are the numbers of one robot. What follows from several of them is a property here.
"""

from math import acos, atan2, cos, degrees, hypot, pi, sqrt

from msgspec import Struct

from legpush.scene.conventions import JOINTS
from legpush.scene.robot_body import Joints, Legs, Trunk
from legpush.scene.robot_motion import Capture, FallLimits, Gait, PushMotion, RoughGait, Stance


class RobotSpec(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The robot. A scenario file states only the numbers that differ from the defaults."""

    trunk: Trunk = Trunk()
    legs: Legs = Legs()
    joints: Joints = Joints()
    stance: Stance = Stance()
    gait: Gait = Gait()
    rough: RoughGait = RoughGait()
    pushing: PushMotion = PushMotion()
    capture: Capture = Capture()
    fall: FallLimits = FallLimits()

    def __post_init__(self) -> None:
        """Check that the legs reach the stance within the limits of their joints.

        Raises:
            ValueError: They do not.
        """
        if not self.legs.foot_radius_m < self.stance.height_m:
            raise ValueError(
                f"Expected legs.foot_radius_m < stance.height_m, got {self.legs.foot_radius_m} and "
                f"{self.stance.height_m}"
            )
        for front in (1.0, -1.0):
            self._require_reach(front)

    @property
    def mass_kg(self) -> float:
        """Mass of the whole robot."""
        return self.trunk.mass_kg + 4 * self.legs.mass_kg

    @property
    def station_m(self) -> float:
        """Distance from the rear face of the box back to the trunk centre when the robot stands ready to push."""
        return self.legs.hip_x_m + self.pushing.gap_m

    @property
    def touchdown_m(self) -> float:
        """Commanded height of the centre of a landing foot, which is pressed a little into the floor."""
        return self.legs.foot_radius_m - self.gait.press_m

    @property
    def fall_height_m(self) -> float:
        """A robot whose trunk is lower has fallen."""
        return self.fall.height_share * self.stance.height_m

    def _require_reach(self, front: float) -> None:
        """Check a left leg of the stance, at the front (1) or at the rear (-1).

        Raises:
            ValueError: The leg does not reach its corner of the foot rectangle.
        """
        legs, stance = self.legs, self.stance
        x = front * (stance.foot_rectangle_length_m / 2 - legs.hip_x_m)
        y = stance.foot_rectangle_width_m / 2 - legs.hip_y_m
        z = legs.foot_radius_m - stance.height_m
        upper, lower, offset = legs.upper_length_m, legs.lower_length_m, legs.hip_offset_m
        drop = sqrt(max(y * y + z * z - offset * offset, 0.0))
        reach = hypot(x, drop)
        straight, folded = (
            sqrt(max(upper * upper + lower * lower + 2 * upper * lower * cos(angle), 0.0))
            for angle in self.joints.knee.limits_rad
        )
        if not (drop > 0.0 and folded <= reach <= straight):
            raise ValueError(
                f"Expected legs that reach the stance: {folded:.3f} to {straight:.3f} m from the hip-y axis to the "
                f"foot within the limits of the knee, got {reach:.3f} m"
            )
        knee = _acos((reach * reach - upper * upper - lower * lower) / (2 * upper * lower))
        hip_y = atan2(-x, drop) + _acos((upper * upper + reach * reach - lower * lower) / (2 * upper * reach))
        hip_x = atan2(z, y) - atan2(-drop, offset)
        for name, joint, angle in zip(JOINTS, self.joints.in_order(), (hip_x, hip_y, knee), strict=True):
            low, high = joint.limits_rad
            wrapped = (angle + pi) % (2 * pi) - pi
            if not low <= wrapped <= high:
                raise ValueError(
                    f"Expected joints.{name} from {joint.min_deg:g} to {joint.max_deg:g}° in the stance, "
                    f"got {degrees(wrapped):.1f}°"
                )


def _acos(cosine: float) -> float:
    """Return the arc cosine of a number that rounding may have put just beyond 1."""
    return acos(min(max(cosine, -1.0), 1.0))
