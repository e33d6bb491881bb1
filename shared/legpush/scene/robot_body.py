"""The robot's body: trunk, legs and joints.

Dimensions are Spot's public ones, and the limits of the joint angles are those of the paper (Table 1). The limits of
torque and speed are those that Spot's simulations use: 45 N m for the hips, and a table for the knee, which the Boston
Dynamics AI Institute measured (Isaac Lab, `isaaclab_assets/robots/spot.py`); 97 N m at rest and none at 14 rad/s for
the knee (RAI Institute, `relic`, `TORQUE_SPEED_LIMIT`). For the hips no such line is published: 20 rad/s is assumed.
"""

from itertools import pairwise
from math import cos, radians, sin
from typing import Annotated

from msgspec import Meta, Struct

from legpush.bounds import (
    MAX_TORQUE_POINTS,
    Armature,
    BodyDistance,
    BodyLength,
    Damping,
    Friction,
    JointAngle,
    JointSpeed,
    KneeAngle,
    PartMass,
    PositionGain,
    Torque,
    Unit,
    VelocityGain,
)


class Trunk(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The trunk of the robot, a box."""

    size_m: tuple[BodyLength, BodyLength, BodyLength] = (0.7, 0.22, 0.17)
    """Length, width and height."""
    cap_shares: tuple[Unit, Unit, Unit] = (0.034, 0.864, 0.824)
    """Half sizes of the boxes in the middles of its front and rear side, as shares of those of the trunk."""
    mass_kg: PartMass = 18.0
    """With the legs, the whole robot weighs 31.84 kg; Spot's public figure is about 32 kg."""

    def ahead_m(self, below_m: float, turn_rad: float) -> float:
        """Return how far the trunk reaches ahead of its centre, where it is turned and at most `below_m` below it."""
        half = [side / 2 for side in self.size_m]
        cap = [share * side for share, side in zip(self.cap_shares, half, strict=True)]
        parts = (half, (half[0] + cap[0], cap[1], cap[2]))
        reaches = [
            length * cos(turn_rad) + width * abs(sin(turn_rad)) for length, width, height in parts if height > below_m
        ]
        return max(reaches, default=0.0)


class Legs(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Lengths, radii and masses of a leg. All four legs are alike."""

    hip_x_m: BodyDistance = 0.298
    """Distance of the hip-x axes ahead of and behind the trunk's centre."""
    hip_y_m: BodyDistance = 0.055
    """Distance of the hip-x axes to the left and right of it."""
    hip_offset_m: BodyLength = 0.111
    """Distance from the hip-x axis to the plane of the leg, the paper's L1."""
    upper_length_m: BodyLength = 0.3205
    """Length of the upper leg, the paper's L2."""
    lower_length_m: BodyLength = 0.37
    """Length of the lower leg, to the centre of the foot sphere, the paper's L3."""
    foot_radius_m: BodyLength = 0.02
    hip_radius_m: BodyLength = 0.055
    upper_radius_m: BodyLength = 0.04
    lower_radius_m: BodyLength = 0.018
    """Radius of the capsule of the lower leg; those of the front legs can touch the box."""
    hip_mass_kg: PartMass = 1.2
    upper_mass_kg: PartMass = 1.7
    lower_mass_kg: PartMass = 0.56
    foot_friction: Friction = 1.0
    """Sliding friction coefficient of foot and floor."""

    @property
    def mass_kg(self) -> float:
        """Mass of one leg."""
        return self.hip_mass_kg + self.upper_mass_kg + self.lower_mass_kg


class Joint(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A joint with its position servo, equal in all legs."""

    min_deg: JointAngle
    max_deg: JointAngle
    position_gain_n_m_rad: PositionGain = 1000.0
    velocity_gain_n_m_s_rad: VelocityGain = 30.0
    max_torque_n_m: Torque = 45.0
    """Largest torque, at rest."""
    max_speed_rad_s: JointSpeed = 20.0
    """The speed at which no torque is left; in between it falls evenly."""
    torque_by_angle: Annotated[tuple[tuple[JointAngle, Torque], ...], Meta(max_length=MAX_TORQUE_POINTS)] = ()
    """Largest torque at angles of the joint, [degrees] and [N m], linear in between; empty if it does not depend on the
    angle."""
    armature_kg_m2: Armature = 0.02
    """Rotor inertia behind the gear."""
    damping_n_m_s_rad: Damping = 0.5
    """Viscous damping."""

    def __post_init__(self) -> None:
        """Check that the limits are in order.

        Raises:
            ValueError: They are not.
        """
        if not self.min_deg < self.max_deg:
            raise ValueError(f"Expected min_deg < max_deg, got {self.min_deg:g} and {self.max_deg:g}")
        angles = [angle for angle, _ in self.torque_by_angle]
        if any(second <= first for first, second in pairwise(angles)):
            raise ValueError(f"Expected angles in torque_by_angle that rise, got {angles}")

    @property
    def limits_rad(self) -> tuple[float, float]:
        """Least and largest angle."""
        return radians(self.min_deg), radians(self.max_deg)


class HipX(Joint, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The joint that spreads the leg, about the x axis."""

    min_deg: JointAngle = -45.0
    max_deg: JointAngle = 45.0


class HipY(Joint, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The joint that swings the leg, about the y axis; a positive angle swings it backward."""

    min_deg: JointAngle = -80.0
    max_deg: JointAngle = 100.0


class Knee(Joint, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The joint that bends the leg; 0 is the straight leg, and the knee points backward."""

    min_deg: KneeAngle = 15.0
    max_deg: KneeAngle = 130.0
    max_torque_n_m: Torque = 96.9972
    max_speed_rad_s: JointSpeed = 14.0
    torque_by_angle: Annotated[tuple[tuple[JointAngle, Torque], ...], Meta(max_length=MAX_TORQUE_POINTS)] = (
        (14.16, 30.60),
        (22.91, 49.18),
        (31.66, 66.06),
        (40.41, 80.78),
        (50.62, 94.73),
        (60.83, 104.86),
        (71.04, 111.01),
        (82.71, 113.24),
        (94.38, 110.69),
        (106.05, 103.94),
        (117.72, 93.66),
        (129.39, 80.55),
        (141.06, 65.27),
        (151.27, 50.54),
        (160.02, 37.17),
    )
    """Every sixth or seventh row of the measured table, as flexion; between them it is within 1 N m of the table."""


class Joints(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The joints of a leg. Their limits are those of Table 1."""

    hip_x: HipX = HipX()
    hip_y: HipY = HipY()
    knee: Knee = Knee()

    def in_order(self) -> tuple[Joint, Joint, Joint]:
        """Return the joints in the order of `JOINTS`."""
        return self.hip_x, self.hip_y, self.knee
