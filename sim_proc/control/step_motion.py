"""The motion of one step: the centre of mass is planned over the steps ahead, and trunk and feet follow."""

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import wrap_angle
from legpush.scene.conventions import CONTROL_PERIOD_S, LEGS, Leg
from sim_proc.control.balance import ComPlan, plan_com, shifted_reference, triangle_margin
from sim_proc.control.feedback.deviation import Deviation
from sim_proc.control.feedback.terrain import Terrain
from sim_proc.control.plant import TickLog, Touchdown
from sim_proc.control.posture import Posture
from sim_proc.control.step import Planned, Step, Swing
from sim_proc.gravity import GRAVITY_M_S2

SHIFT_WEIGHT: Final = 0.02
"""Weight of the ZMP reference while four feet stand; it is 1 while three do."""
LAST_SHARE: Final = 0.05
"""Share of its full load planned for a foot in the tick before its lift. With none it would leave the floor and touch
it again before it rises; with twice as much it would push itself off."""
LIFTED_SHARE: Final = 1e-4
"""Share of its full load planned for a foot in the air: nothing, but the forces stay determined."""
TOLD_TICKS: Final = 2
"""Feet that have slipped are told from feet that come late if motions are at most this much later than planned."""
OTHERS: Final = tuple([leg for leg in range(len(LEGS)) if leg != lifted] for lifted in range(len(LEGS)))
"""The feet that stand while each leg is up."""
CAUTION: Final = ((0, 0.0), (5, 0.0), (10, 1.5), (15, 3.0), (15, 6.0))
"""Ticks to lengthen the shift, and multiples of the robot's least margin to widen the ZMP's margin by.

They are tried in order, until the CoM's ground projection is planned to keep the least margin.
"""


class StepMotion:
    """Plans and carries out the motions that steps are made of."""

    def __init__(self, posture: Posture) -> None:
        """Begin with all feet down."""
        self.posture = posture
        robot = posture.plant.robot
        self._gait, self._com_height_m, self._touchdown_m = robot.gait, robot.stance.com_height_m, robot.touchdown_m
        """The gait, the height of the pendulum, and that of a landing foot."""
        self.landed: int | None = None
        """Index of the leg that the last step put down."""
        self._carried: tuple[int, ...] = ()
        """Legs that were searched for the floor in the present step, and found it."""
        self._contact_n = robot.gait.contact_share * posture.plant.mass_kg * GRAVITY_M_S2
        """Load from which on a foot is down."""
        self._pressing_n = robot.capture.pressing_share * posture.plant.mass_kg * GRAVITY_M_S2
        """Force on the box from which on its reaction moves the robot."""
        self._terrain = Terrain(robot)
        self._deviation = Deviation(robot.capture, robot.stance.com_height_m)

    @property
    def _lean_m(self) -> Floats:
        """From the point below the CoM to where its plumb line meets a sloping floor, (2,)."""
        lean: Floats = self._com_height_m * self.posture.plant.downhill
        return lean

    def _move(
        self,
        step: Step,
        plan: ComPlan,
        swing: Swing | None,
        until: Touchdown | None,
        *,
        uncorrected: Floats | None = None,
    ) -> TickLog:
        """Carry out a step with its planned motion of the CoM, up to the touchdown of a foot that is to land."""
        posture, gait = self.posture, self._gait
        leg = None if step.leg is None else LEGS.index(step.leg)
        n = step.n_ticks
        feet = np.repeat(posture.feet_m[None], n, axis=0)
        load_share = np.ones((n, 4))
        ramp = min(gait.ramp_ticks, step.shift_ticks)
        if self.landed is not None and ramp > 0:
            load_share[:ramp, self.landed] = _ramp(gait.landed_share, 1.0, ramp)
        if leg is not None and swing is not None:
            feet[step.shift_ticks :, leg] = swing(posture.feet_m[leg])
            unload = load_share[step.shift_ticks - ramp : step.shift_ticks, leg]
            np.minimum(unload, _ramp(1.0, LAST_SHARE, ramp), out=unload)
            load_share[step.shift_ticks :, leg] = LIFTED_SHARE
            if until is not None and until.first_tick < n:
                load_share[-1 if until.stops_leg else 0 :, leg] = gait.landed_share
        yaw, yaw_rate = turn(posture.yaw_rad, posture.yaw_rate_rad_s, step.end_yaw_rad, n)
        self._deviation.tell(posture.plant.late_ticks)
        told = leg is not None and self._deviation.late_ticks <= TOLD_TICKS
        least_m = self._terrain.least_heights_m(posture.feet_m, leg) if told and leg is not None else None
        watch = self._deviation.watch(plan, n, least_m)
        watch.pressing_n = self._pressing_n
        log = posture.track(
            plan.position_m[:n] - posture.com_offset_m,
            yaw,
            feet,
            load_share,
            plan.zmp_m[:n] + self._lean_m,
            plan.acceleration_m_s2[:n],
            until,
            watch,
            None if step.push is None else step.push.after(step.shift_ticks),
            uncorrected,
        )
        if not log.left_plan:
            self._deviation.learn(watch, rough=self._terrain.rough)
        last = len(log.qpos) - 1
        posture.com_state = plan.state(last)
        posture.yaw_rate_rad_s = float(yaw_rate[last])
        return log

    def require_reach(
        self, what: str, ahead: Sequence[Step], swing: Swing, within_m: Callable[[Floats], Floats]
    ) -> Planned:
        """Plan `ahead[0]`, and check that its leg follows its whole swing, with the trunk moving so. Nothing moves.

        `what` names the swing in the error, and `within_m` says how far from its points (n, 3) the foot may be, (n,).

        Raises:
            MotionError: It does not.
        """
        other = copy(self)
        other.posture = posture = self.posture.measured()
        step, plan = other._plan(ahead)
        leg, air = LEGS.index(step.leg or LEGS[0]), slice(step.shift_ticks, step.n_ticks)
        yaw, _ = turn(posture.yaw_rad, posture.yaw_rate_rad_s, step.end_yaw_rad, step.n_ticks)
        trunk = plan.position_m[air] - posture.com_offset_m
        curve_m = swing(posture.feet_m[leg])
        posture.require_reach(what, leg, trunk, yaw[air], curve_m, within_m(curve_m))
        return step, plan

    def _touchdown(
        self,
        leg: Leg,
        step: Step,
        first_tick: int,
        landing_tick: int,
        *,
        stops_leg: bool,
        blocked_tick: int | None = None,
        late: int | None = None,
    ) -> Touchdown:
        """The touchdown that ends a swing. Its ticks count from the lift, and are those of commands that are in time.

        They become `late` ticks later, if not by as much as commands are known to be late.
        """
        late = (self.posture.plant.late_ticks or 0) if late is None else late
        flies = step.shift_ticks + late
        return Touchdown(
            leg=LEGS.index(leg),
            force_n=self._contact_n,
            lift_tick=step.shift_ticks,
            carried=self._carried,
            first_tick=flies + first_tick,
            landing_tick=flies + landing_tick,
            blocked_tick=flies + (step.swing_ticks if blocked_tick is None else blocked_tick),
            stops_leg=stops_leg,
            late_ticks=late,
        )

    def _plan(self, ahead: Sequence[Step]) -> Planned:
        """The first step, with a shift long enough for a stable lift, and the planned motion of the CoM."""
        first = ahead[0]
        if first.leg is None or first.shift_ticks == 0:
            return first, self._plan_com(ahead)
        support = self.posture.feet_m[OTHERS[LEGS.index(first.leg)], :2]
        least_m = self._gait.least_margin_m
        for longer, wider in CAUTION:
            step = replace(first, shift_ticks=first.shift_ticks + longer, margin_m=first.margin_m + wider * least_m)
            plan = self._plan_com([step, *ahead[1:]])
            if (
                triangle_margin(plan.position_m[step.shift_ticks : step.n_ticks] + self._lean_m, support).min()
                >= least_m
            ):
                break
        return step, plan

    def _plan_com(self, ahead: Sequence[Step]) -> ComPlan:
        """The motion of the CoM over all of these steps."""
        posture = self.posture
        feet = posture.feet_m[:, :2].copy()
        references = np.empty((sum(step.n_ticks for step in ahead), 2))
        weights: tuple[float, ...] = ()
        for step in ahead:
            reference = step.nominal_xy_m
            if step.leg is not None:
                leg = LEGS.index(step.leg)
                reference = shifted_reference(reference, feet[OTHERS[leg]], step.margin_m)
                feet[leg] = step.target_m
            references[len(weights) : len(weights) + step.n_ticks] = reference - self._lean_m
            weights += (SHIFT_WEIGHT,) * step.shift_ticks + (1.0,) * step.swing_ticks
        return plan_com(
            posture.com_state,
            references,
            weights,
            ahead[-1].end_velocity_m_s,
            self._com_height_m,
        )


@lru_cache
def _ramp(start: float, end: float, n_ticks: int) -> Floats:
    """Values at the ends of `n_ticks` ticks in which they go evenly from `start` to `end`, (n,), not to be changed."""
    return np.linspace(start, end, n_ticks + 1)[1:]


def turn(start_rad: float, start_rate_rad_s: float, end_rad: float, n_ticks: int) -> tuple[Floats, Floats]:
    """A cubic from the present yaw and rate to `end_rad`, (n,), and its rates, (n,), the last of which is the mean."""
    duration = n_ticks * CONTROL_PERIOD_S
    change = wrap_angle(end_rad - start_rad)
    (start, middle, end), (start_rate, middle_rate, end_rate) = _hermite(n_ticks)
    rate = change / duration
    start_slope, end_slope = start_rate_rad_s * duration, rate * duration
    yaw = start_rad + start_slope * start + change * middle + end_slope * end
    yaw_rate = start_slope * start_rate + change * 6 * middle_rate + end_slope * end_rate
    return yaw, yaw_rate / duration


@lru_cache
def _hermite(n_ticks: int) -> tuple[list[Floats], list[Floats]]:
    """The cubic Hermite basis of start slope, change and end slope at the ends of ticks, (n,) each, and its slopes.

    That of the change is divided by 6.
    """
    u = np.arange(1, n_ticks + 1) / n_ticks
    square, cube = u**2, u**3
    return (
        [u - 2 * square + cube, 3 * square - 2 * cube, cube - square],
        [1 - 4 * u + 3 * square, u - square, 3 * square - 2 * u],
    )
