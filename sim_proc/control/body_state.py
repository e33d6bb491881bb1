"""The motion of the robot as control knows it: exact where sensing is, estimated where it is not."""

from dataclasses import dataclass

from legpush.arrays import Floats


@dataclass(frozen=True, kw_only=True)
class BodyState:
    """Trunk, feet and centre of mass at one moment, in the frame of all measurements; z points up."""

    position_m: Floats
    """Middle of the trunk, (3,)."""
    rotation: Floats
    """From the frame of the trunk to that of all measurements, (3, 3)."""
    velocity_m_s: Floats
    """Of the middle of the trunk, (3,)."""
    angular_velocity_rad_s: Floats
    """Of the trunk, (3,)."""
    tips_m: Floats
    """Centres of the foot spheres, (4, 3)."""
    loads_n: Floats
    """What each foot carries, (4,): its vertical force, as the foot feels it."""
    com_m: Floats
    """Centre of mass of the robot, (3,)."""
    com_velocity_m_s: Floats
    """Its velocity, (3,)."""
