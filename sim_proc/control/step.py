"""A step of one leg, as walking and pushing plan it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import Leg
from legpush.scene.robot_motion import Gait
from sim_proc.control.balance import ComPlan
from sim_proc.control.push_force import PushForce


@dataclass(frozen=True, kw_only=True)
class Step:
    """A step of one leg, and the motion of the trunk meanwhile."""

    leg: Leg | None
    """With None all feet stay down and the weight comes to rest at `nominal_xy_m`."""
    shift_ticks: int
    swing_ticks: int
    target_m: Floats
    """Where the foot comes down, (2,)."""
    nominal_xy_m: Floats
    """Position of the centre of mass half way through the swing, (2,)."""
    end_velocity_m_s: Floats
    """Velocity of the centre of mass after the step, used if no step follows, (2,)."""
    end_yaw_rad: float
    margin_m: float
    """Wanted distance of the ZMP inside the support polygon while the leg is up."""
    push: PushForce | None = None
    """What the foot in the air does to the box, at the ticks of the swing."""

    @property
    def n_ticks(self) -> int:
        """Duration of the step."""
        return self.shift_ticks + self.swing_ticks


Swing = Callable[[Floats], Floats]
"""A function from the place of a foot, (3,), to its curve through the air, (swing_ticks, 3)."""


Planned = tuple[Step, ComPlan]
"""A step, with its shift as long as a stable lift takes, and the planned motion of the CoM over the steps ahead."""


def rest(gait: Gait, nominal_xy_m: Floats, yaw_rad: float) -> Step:
    """A step that keeps all feet down and brings the centre of mass to `nominal_xy_m`."""
    return Step(
        leg=None,
        shift_ticks=gait.settle_ticks // 2,
        swing_ticks=gait.settle_ticks // 2,
        target_m=nominal_xy_m,
        nominal_xy_m=nominal_xy_m,
        end_velocity_m_s=np.zeros(2),
        end_yaw_rad=yaw_rad,
        margin_m=0.0,
    )
