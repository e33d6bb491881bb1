"""One step of one leg: shift the weight off it, swing it, put it down. Walking and pushing are sequences of these."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import wrap_angle
from legpush.scene.robot import CONTROL_PERIOD_S, LEGS, Leg
from sim_proc.control.balance import ComPlan, plan_com, shifted_reference, triangle_margin
from sim_proc.control.plant import TickLog
from sim_proc.control.posture import Posture
from sim_proc.kinematics.body import STANDING_HEIGHT_M

COM_HEIGHT_M: Final = STANDING_HEIGHT_M - 0.05
"""Height of the pendulum: the legs hang below the trunk."""
SHIFT_WEIGHT: Final = 0.02
"""How much the ZMP reference counts while four feet stand, against 1 while three do."""
RAMP_TICKS: Final = 5
"""A foot is loaded, and unloaded, over this long."""
LIFTED_SHARE: Final = 0.05
"""Of its full load, planned for a foot in the air: a foot that was planned to carry nothing bounces when it lands."""
LEAST_MARGIN_M: Final = 0.01
"""Planned distance of the CoM's ground projection inside the support polygon, below which a leg is not lifted yet."""
CAUTION: Final = ((0, 0.0), (5, 0.0), (10, 0.015), (15, 0.03), (15, 0.06))
"""By how many ticks the shift before a step is made longer, and the ZMP's margin wider [m], until that is planned."""


@dataclass(frozen=True, kw_only=True)
class Step:
    """What one leg does next, and where the trunk should be meanwhile."""

    leg: Leg | None
    """None: all feet stay down and the weight comes to rest at `nominal_xy_m`."""
    shift_ticks: int
    swing_ticks: int
    target_m: Floats
    """Where the foot comes down, (2,)."""
    nominal_xy_m: Floats
    """Of the trunk's centre of mass half way through the swing, (2,)."""
    end_velocity_m_s: Floats
    """Of the trunk after the step, where no step follows, (2,)."""
    end_yaw_rad: float
    margin_m: float
    """Wanted of the ZMP inside the support polygon while the leg is up."""

    @property
    def n_ticks(self) -> int:
        """Length of the step."""
        return self.shift_ticks + self.swing_ticks


Swing = Callable[[Floats], Floats]
"""From where the foot is, (3,), to its curve through the air, (swing_ticks, 3)."""


class Steps:
    """Takes steps, one at a time, each with the motion of the centre of mass planned over the steps ahead."""

    def __init__(self, posture: Posture) -> None:
        """Begin with all feet down."""
        self.posture = posture
        self._lean_m: Floats = COM_HEIGHT_M * posture.plant.downhill
        """From below the CoM to where its plumb line meets a floor that slopes, (2,)."""
        self.landed: int | None = None
        """The leg that the last step put down."""
        self.n_footsteps = 0

    def take(self, ahead: Sequence[Step], swing: Swing | None, *, lands: bool = True) -> TickLog:
        """Carry out `ahead[0]`; the others are what is expected to follow.

        With `lands=False` the foot stays in the air, and the next step must move the same leg without a shift.
        """
        posture = self.posture
        airborne = ahead[0].shift_ticks == 0
        if not airborne:
            posture.measure()
        step, plan = self._plan(ahead)
        leg = None if step.leg is None else LEGS.index(step.leg)
        n = step.n_ticks
        feet = np.repeat(posture.feet_m[None], n, axis=0)
        load_share = np.ones((n, 4))
        if self.landed is not None and not airborne:
            ramp = min(RAMP_TICKS, step.shift_ticks)
            load_share[:ramp, self.landed] = np.linspace(LIFTED_SHARE, 1.0, ramp + 1)[1:]
        if leg is not None and swing is not None:
            feet[step.shift_ticks :, leg] = swing(posture.feet_m[leg])
            ramp = min(RAMP_TICKS, step.shift_ticks)
            unload = load_share[step.shift_ticks - ramp : step.shift_ticks, leg]
            np.minimum(unload, np.linspace(1.0, LIFTED_SHARE, ramp + 1)[1:], out=unload)
            load_share[step.shift_ticks :, leg] = LIFTED_SHARE
        yaw, end_rate = _turn(posture.yaw_rad, posture.yaw_rate_rad_s, step.end_yaw_rad, n)
        recording = posture.track(
            plan.position_m[:n] - posture.com_offset_m,
            yaw,
            feet,
            load_share,
            plan.zmp_m[:n] + self._lean_m,
            plan.acceleration_m_s2[:n],
        )
        posture.com_state = plan.state(n - 1)
        posture.yaw_rate_rad_s = end_rate
        self.landed = leg if lands else None
        self.n_footsteps += int(lands and leg is not None)
        return recording

    def _plan(self, ahead: Sequence[Step]) -> tuple[Step, ComPlan]:
        """The first step, its shift as long as its margin asks for, and the motion of the CoM."""
        first = ahead[0]
        if first.leg is None or first.shift_ticks == 0:
            return first, self._plan_com(ahead)
        support = np.delete(self.posture.feet_m[:, :2], LEGS.index(first.leg), axis=0)
        for longer, wider_m in CAUTION:
            step = replace(first, shift_ticks=first.shift_ticks + longer, margin_m=first.margin_m + wider_m)
            plan = self._plan_com([step, *ahead[1:]])
            if (
                triangle_margin(plan.position_m[step.shift_ticks : step.n_ticks] + self._lean_m, support).min()
                >= LEAST_MARGIN_M
            ):
                break
        return step, plan

    def _plan_com(self, ahead: Sequence[Step]) -> ComPlan:
        posture = self.posture
        feet = posture.feet_m[:, :2].copy()
        references, weights = [], []
        for step in ahead:
            reference = step.nominal_xy_m
            if step.leg is not None:
                leg = LEGS.index(step.leg)
                reference = shifted_reference(reference, np.delete(feet, leg, axis=0), step.margin_m)
                feet[leg] = step.target_m
            references.append(np.repeat(reference[None] - self._lean_m, step.n_ticks, axis=0))
            weights += [SHIFT_WEIGHT] * step.shift_ticks + [1.0] * step.swing_ticks
        return plan_com(
            posture.com_state, np.concatenate(references), tuple(weights), ahead[-1].end_velocity_m_s, COM_HEIGHT_M
        )


def _turn(start_rad: float, start_rate_rad_s: float, end_rad: float, n_ticks: int) -> tuple[Floats, float]:
    """A cubic from the present yaw and rate to `end_rad`, (n,), and its rate at the end: the mean rate of the turn."""
    duration = n_ticks * CONTROL_PERIOD_S
    change = wrap_angle(end_rad - start_rad)
    u = np.arange(1, n_ticks + 1) / n_ticks
    rate = change / duration
    start_slope, end_slope = start_rate_rad_s * duration, rate * duration
    yaw = start_rad + start_slope * (u - 2 * u**2 + u**3) + change * (3 * u**2 - 2 * u**3) + end_slope * (u**3 - u**2)
    return yaw, rate
