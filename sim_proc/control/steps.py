"""Steps of single legs: shift the weight off a leg, swing it, and put it down.

Walking and pushing are sequences of such steps.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import lru_cache, partial
from math import ceil
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import LEGS, Leg
from sim_proc.control.balance import ComPlan, plan_com, shifted_reference, triangle_margin
from sim_proc.control.feedback.capture import CaptureTrot
from sim_proc.control.feedback.deviation import Deviation
from sim_proc.control.feedback.terrain import Terrain
from sim_proc.control.plant import TickLog, Touchdown, joined
from sim_proc.control.posture import Posture
from sim_proc.control.step import Planned, Step, Swing, rest
from sim_proc.control.swing import APEX_SHARE, flight_ticks, landing_swing, search_swing
from sim_proc.control.turning import turn
from sim_proc.gravity import GRAVITY_M_S2

SHIFT_WEIGHT: Final = 0.02
"""Weight of the ZMP reference while four feet stand; it is 1 while three do."""
LAST_SHARE: Final = 0.05
"""Share of its full load planned for a foot in the tick before its lift. With none it would leave the floor and touch
it again before it rises; with twice as much it would push itself off."""
LIFTED_SHARE: Final = 1e-4
"""Share of its full load planned for a foot in the air: nothing, but the forces stay determined."""
OTHERS: Final = tuple([leg for leg in range(len(LEGS)) if leg != lifted] for lifted in range(len(LEGS)))
"""The feet that stand while each leg is up."""
CAUTION: Final = ((0, 0.0), (5, 0.0), (10, 1.5), (15, 3.0), (15, 6.0))
"""Ticks to lengthen the shift, and multiples of the robot's least margin to widen the ZMP's margin by.

They are tried in order, until the CoM's ground projection is planned to keep the least margin.
"""


class Steps:
    """Takes one step at a time, and plans the motion of the centre of mass over the steps ahead for each."""

    def __init__(self, posture: Posture) -> None:
        """Begin with all feet down."""
        self.posture = posture
        robot = posture.plant.robot
        self._gait, self._com_height_m, self._touchdown_m = robot.gait, robot.stance.com_height_m, robot.touchdown_m
        """The gait, the height of the pendulum, and that of a landing foot."""
        self._lean_m: Floats = self._com_height_m * posture.plant.downhill
        """From the point below the CoM to where its plumb line meets a sloping floor, (2,)."""
        self.landed: int | None = None
        """Index of the leg that the last step put down."""
        self.without_floor: Leg | None = None
        """Leg that found no floor in the last step, and went back to where it stood."""
        self.captured = False
        """Whether the last step was given up for capture steps. Then the robot stands with all feet down."""
        self._terrain = Terrain(robot)
        self._missed = False
        """Whether the last foot came down far from its place."""
        self._rests = False
        """Whether it carries nothing, because its leg rests on an edge."""
        self._contact_n = robot.gait.contact_share * posture.plant.mass_kg * GRAVITY_M_S2
        """Load from which on a foot is down."""
        self._deviation = Deviation(robot.capture, robot.stance.com_height_m)
        self._carried: tuple[int, ...] = ()
        """Legs that were searched for the floor in the present step, and found it."""
        self._footholds_m = posture.feet_m.copy()
        """Where each foot stood before its last step, (4, 3)."""
        self.n_footsteps = 0

    def take_step(
        self, ahead: Sequence[Step], swing: Swing | None, *, lands: bool = True, planned: Planned | None = None
    ) -> TickLog:
        """Carry out `ahead[0]`. The other steps are those expected to follow.

        With `lands=False` the foot stays in the air, and the next step must move the same leg without a shift.
        `planned` is what `require_reach` planned of these steps, if it has.
        """
        self.without_floor, self.captured, self._missed = None, False, False
        logs = self._step(ahead, swing, lands=lands, planned=planned)
        if self._missed and not self.posture.plant.fallen and not logs[-1].left_plan:
            again = replace(ahead[0], shift_ticks=0, target_m=self._second_place_m(ahead[0]))
            logs.append(self._lift_and_swing([again, *ahead[1:]], None, lands=True))
        if logs[-1].left_plan and not self.posture.plant.fallen:
            logs += self._capture(None if ahead[0].leg is None else LEGS.index(ahead[0].leg))
        return joined(logs)

    def _step(
        self, ahead: Sequence[Step], swing: Swing | None, *, lands: bool, planned: Planned | None = None
    ) -> list[TickLog]:
        """Carry out `ahead[0]`, and put feet down before that are not down when they should be."""
        self._carried = ()
        logs = [self._lift_and_swing(ahead, swing, lands=lands, planned=planned)]
        while (missing := logs[-1].not_down) is not None and not logs[-1].left_plan:
            leg, place_m = LEGS[missing], self.posture.feet_m[missing, :2].copy()
            logs += self._search(leg, [replace(ahead[0], leg=leg, target_m=place_m), *ahead[1:]])
            if logs[-1].left_plan:
                break
            self._put_down(leg, place_m)
            if self.without_floor is not None or self.posture.plant.fallen:
                break
            self._carried += (missing,)
            logs.append(self._lift_and_swing(ahead, swing, lands=lands))
        return logs

    def _capture(self, leg: int | None) -> list[TickLog]:
        """Take capture steps until the robot stands with all feet down. `leg` is the one that was to step."""
        posture = self.posture
        carries = leg is None or posture.plant.body_state().loads_n[leg] >= self._contact_n
        lifted = None if carries else leg
        logs: list[TickLog] = []
        if self._terrain.rough:
            logs += self._recover([] if lifted is None else self._set_down(LEGS[lifted]))
            for _ in range(posture.plant.robot.capture.most_trots):
                if posture.plant.fallen or not logs[-1].left_plan:
                    return logs
                logs += self._recover([])
            lifted = None
        for _ in range(posture.plant.robot.capture.most_trots):
            trot = CaptureTrot(posture, uneven=self._terrain.rough)
            logs += self._recover(trot.run(lifted))
            self.n_footsteps += trot.n_footsteps
            self._deviation.allow_more()
            lifted = None
            if posture.plant.fallen or not logs[-1].left_plan:
                break
        return logs

    def _recover(self, logs: list[TickLog]) -> list[TickLog]:
        """Come to rest after a motion that was not planned."""
        posture = self.posture
        if posture.plant.fallen:
            return logs
        self.captured, self.landed, self._carried = True, None, ()
        posture.resume(self._touchdown_m)
        self._terrain.feel(posture.feet_m, missed=False)
        posture.height_goal_m = self._terrain.trunk_height_m(posture.feet_m)
        logs.append(self._come_to_rest())
        self._footholds_m = posture.feet_m.copy()
        return logs

    def _set_down(self, leg: Leg) -> list[TickLog]:
        """Put a foot down where it is, at once."""
        posture, index = self.posture, LEGS.index(leg)
        curve = self._terrain.down(posture.feet_m[index], posture.plant.tips_m())
        middle_m = posture.feet_m[:, :2].mean(axis=0)
        step = replace(rest(self._gait, middle_m, posture.yaw_rad), leg=leg, shift_ticks=0, swing_ticks=len(curve))
        step = replace(step, target_m=curve[0, :2])
        until = self._touchdown(leg, step, 0, step.swing_ticks, stops_leg=True, blocked_tick=2)
        return [self._move(step, self._plan_com([step]), lambda _: curve, until, watched=False)]

    def _lift_and_swing(
        self, ahead: Sequence[Step], swing: Swing | None, *, lands: bool, planned: Planned | None = None
    ) -> TickLog:
        """Carry out `ahead[0]`, up to the lift if another foot is not down then.

        On a rough floor the foot steps higher than the swing, unless it is in the air already.
        """
        posture, leg = self.posture, ahead[0].leg
        if ahead[0].shift_ticks > 0:
            posture.measure(heights=self._terrain.rough)
            posture.height_goal_m = self._terrain.trunk_height_m(posture.feet_m)
            if leg is not None:
                self._footholds_m[LEGS.index(leg)] = posture.feet_m[LEGS.index(leg)]
        rough = lands and self._terrain.rough and (ahead[0].shift_ticks > 0 or swing is None)
        if rough and leg is not None:
            curve = self._terrain.swing(posture.feet_m, LEGS.index(leg), ahead[0].target_m)
            ahead, swing = [replace(ahead[0], swing_ticks=len(curve)), *ahead[1:]], lambda _: curve
        step, plan = planned or self._plan(ahead)
        until = None
        if leg is not None and rough:
            rises, n_ticks = self._terrain.apex_ticks, step.swing_ticks
            slow = self._terrain.slow_from_tick
            until = self._touchdown(leg, step, rises, n_ticks, stops_leg=True, blocked_tick=slow)
        elif leg is not None:
            flight = flight_ticks(step.swing_ticks, self._gait) if lands else step.swing_ticks
            first_tick = ceil(APEX_SHARE * flight) if lands else flight
            until = self._touchdown(leg, step, first_tick, flight, stops_leg=True)
        log = self._move(step, plan, swing, until)
        if log.not_down is not None or log.left_plan or posture.plant.fallen:
            return log
        self.landed = None
        if leg is None or not lands:
            return log
        logs = [log] if log.touched_down else [log, *self._search(leg, ahead)]
        if logs[-1].left_plan:
            return joined(logs)
        self._put_down(leg, ahead[0].target_m)
        self.n_footsteps += int(self.without_floor is None)
        return joined(logs)

    def _put_down(self, leg: Leg, target_m: Floats) -> None:
        posture = self.posture
        self.landed = LEGS.index(leg)
        posture.put_down(self.landed, self._touchdown_m)
        state = posture.plant.body_state()
        self._rests = bool(state.loads_n[self.landed] < self._contact_n)
        far = self._terrain.has_missed(state.tips_m[self.landed], target_m)
        self._missed = self.without_floor is None and (far or (self._rests and self._terrain.rough))
        self._terrain.feel(posture.feet_m, missed=self._missed)

    def _second_place_m(self, step: Step) -> Floats:
        """Where a foot that missed its place steps next, (2,): to the same place, or nearer if an edge holds it."""
        if not self._rests or step.leg is None:
            return step.target_m
        back_m = self._footholds_m[LEGS.index(step.leg), :2] - step.target_m
        return step.target_m + self._terrain.back_m * back_m / max(float(np.linalg.norm(back_m)), self._terrain.back_m)

    def stop(self) -> TickLog:
        """Come to rest with all feet down, in the middle of them."""
        middle = self.posture.feet_m[:, :2].mean(axis=0)
        log = self.take_step([rest(self._gait, middle, self.posture.yaw_rad)], None)
        self.posture.com_state[1:] = 0.0
        return log

    def _come_to_rest(self) -> TickLog:
        """The same, up to where the robot is too far from that plan, and without measuring the feet before."""
        posture = self.posture
        step, plan = self._plan([rest(self._gait, posture.feet_m[:, :2].mean(axis=0), posture.yaw_rad)])
        log = self._move(step, plan, None, None)
        posture.com_state[1:] = 0.0
        return log

    def _search(self, leg: Leg, ahead: Sequence[Step]) -> list[TickLog]:
        """Look for the floor below a foot that did not meet it, with the weight on the other feet.

        If there is none the foot goes back to where it stood.
        """
        posture, gait = self.posture, self._gait
        curve = search_swing(posture.feet_m[LEGS.index(leg)], gait)
        search = replace(ahead[0], shift_ticks=0, swing_ticks=len(curve))
        step, plan = self._plan([search, *ahead[1:]])
        until = self._touchdown(leg, step, 0, step.swing_ticks, stops_leg=False, blocked_tick=0)
        logs = [self._move(step, plan, lambda _: curve, until)]
        if logs[-1].touched_down or logs[-1].left_plan or posture.plant.fallen:
            return logs
        self.without_floor = leg
        back_m, n_ticks = self._footholds_m[LEGS.index(leg)], gait.swing_ticks
        back = replace(search, swing_ticks=n_ticks, target_m=back_m[:2])
        swing = partial(landing_swing, end_m=back_m, height_m=gait.step_height_m, n_ticks=n_ticks, gait=gait)
        step, plan = self._plan([back, *ahead[1:]])
        return [*logs, self._move(step, plan, swing, self._touchdown(leg, step, n_ticks // 2, n_ticks, stops_leg=True))]

    def _move(
        self, step: Step, plan: ComPlan, swing: Swing | None, until: Touchdown | None, *, watched: bool = True
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
        least_m = None if leg is None else self._terrain.least_heights_m(posture.feet_m, leg)
        watch = self._deviation.watch(plan, n, least_m)
        log = posture.track(
            plan.position_m[:n] - posture.com_offset_m,
            yaw,
            feet,
            load_share,
            plan.zmp_m[:n] + self._lean_m,
            plan.acceleration_m_s2[:n],
            until,
            watch if watched else None,
        )
        if not log.left_plan:
            self._deviation.learn(watch)
        last = len(log.qpos) - 1
        posture.com_state = plan.state(last)
        posture.yaw_rate_rad_s = float(yaw_rate[last])
        return log

    def require_reach(self, what: str, ahead: Sequence[Step], swing: Swing) -> Planned:
        """Plan `ahead[0]`, and check that its leg follows its whole swing, with the trunk moving so. Nothing moves.

        `what` names the swing in the error.

        Raises:
            MotionError: It does not.
        """
        other = copy(self)
        other.posture = posture = self.posture.measured()
        step, plan = other._plan(ahead)
        leg, air = LEGS.index(step.leg or LEGS[0]), slice(step.shift_ticks, step.n_ticks)
        yaw, _ = turn(posture.yaw_rad, posture.yaw_rate_rad_s, step.end_yaw_rad, step.n_ticks)
        trunk = plan.position_m[air] - posture.com_offset_m
        posture.require_reach(what, leg, trunk, yaw[air], swing(posture.feet_m[leg]))
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
    ) -> Touchdown:
        """The touchdown that ends a swing. Its ticks count from the lift."""
        return Touchdown(
            leg=LEGS.index(leg),
            force_n=self._contact_n,
            lift_tick=step.shift_ticks,
            carried=self._carried,
            first_tick=step.shift_ticks + first_tick,
            landing_tick=step.shift_ticks + landing_tick,
            blocked_tick=step.shift_ticks + (step.swing_ticks if blocked_tick is None else blocked_tick),
            stops_leg=stops_leg,
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
