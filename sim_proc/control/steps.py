"""Steps of single legs: shift the weight off a leg, swing it, and put it down.

Walking and pushing are sequences of such steps.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import ceil
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import LEGS, Leg
from sim_proc.control.feedback.capture import CaptureTrot
from sim_proc.control.feedback.footing import Footing
from sim_proc.control.plant import TickLog, joined
from sim_proc.control.posture import Posture
from sim_proc.control.step import Planned, Step, Swing, rest
from sim_proc.control.step_motion import StepMotion
from sim_proc.control.swing import APEX_SHARE, flight_ticks, landing_swing, minimum_jerk, search_swing

MOST_AGAIN: Final = 6
"""How often a foot that missed its place, or whose leg an edge holds, steps again before the robot goes on."""
UNLEVELLED: Final = 1.0 - minimum_jerk(24)
"""Share of a correction that is left after each of the first ticks, while a robot that has slipped levels its trunk."""


class Steps(StepMotion):
    """Takes one step at a time, and does what the floor and disturbances ask for."""

    def __init__(self, posture: Posture) -> None:
        """Begin with all feet down."""
        super().__init__(posture)
        self.without_floor: Leg | None = None
        """Leg that found no floor in the last step, and went back to where it stood."""
        self.captured = False
        """Whether the last step was given up for capture steps. Then the robot stands with all feet down."""
        self._missed = False
        """Whether the last foot came down far from its place."""
        self._rests = False
        """Whether it carries nothing, because its leg rests on an edge."""
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
        for n_again in range(MOST_AGAIN):
            # A foot that is far from its place even the second time, as with commands that come late, stays there. One
            # that is to stay in the air, as in a push, has missed nothing.
            stays = not lands or not self._missed or (n_again > 0 and not self._rests)
            if stays or self.posture.plant.fallen or logs[-1].left_plan:
                break
            ahead = [replace(ahead[0], shift_ticks=0, target_m=self._next_place_m(ahead[0])), *ahead[1:]]
            logs.append(self._lift_and_swing(ahead, None, lands=True))
        if logs[-1].left_plan and not self.posture.plant.fallen:
            logs += self._capture(None if ahead[0].leg is None else LEGS.index(ahead[0].leg))
        return joined(logs)

    def _step(
        self, ahead: Sequence[Step], swing: Swing | None, *, lands: bool, planned: Planned | None = None
    ) -> list[TickLog]:
        """Carry out `ahead[0]`, and put feet down before that are not down when they should be."""
        self._carried = ()
        logs = [self._lift_and_swing(ahead, swing, lands=lands, planned=planned)]
        while (missing := logs[-1].not_down) is not None:
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
            for _ in range(posture.plant.robot.capture.most_trots + 1):
                logs += self._recover(Footing(posture).run(), slipped=True)
                if posture.plant.fallen or not logs[-1].left_plan:
                    return logs
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

    def _recover(self, logs: list[TickLog], *, slipped: bool = False) -> list[TickLog]:
        """Come to rest after a motion that was not planned: after a trot, or where feet slipped off an edge."""
        posture = self.posture
        if posture.plant.fallen:
            return logs
        if slipped:
            self._deviation.forget()
        self.captured, self.landed, self._carried = True, None, ()
        posture.resume(self._touchdown_m, self._contact_n, uneven=slipped)
        self._terrain.feel(posture.feet_m, missed=False)
        posture.height_goal_m = self._terrain.trunk_height_m(posture.feet_m)
        logs.append(self._come_to_rest(UNLEVELLED if slipped else None))
        self._footholds_m = posture.feet_m.copy()
        return logs

    def _lift_and_swing(
        self, ahead: Sequence[Step], swing: Swing | None, *, lands: bool, planned: Planned | None = None
    ) -> TickLog:
        """Carry out `ahead[0]`, up to the lift if another foot is not down then.

        On a rough floor the foot steps higher than the swing, unless it is in the air already.
        """
        posture, leg = self.posture, ahead[0].leg
        self._missed = False
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

    def _next_place_m(self, step: Step) -> Floats:
        """Where a foot that missed its place steps next, (2,): to the same place, or nearer if an edge holds its leg.

        The nearest place is the one where it stood before.
        """
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

    def _come_to_rest(self, uncorrected: Floats | None) -> TickLog:
        """The same, up to where the robot is too far from that plan, and without measuring the feet before.

        `uncorrected` is the share of a correction that is left after each of the first ticks, if not the usual one.
        """
        posture = self.posture
        step, plan = self._plan([rest(self._gait, posture.feet_m[:, :2].mean(axis=0), posture.yaw_rad)])
        log = self._move(step, plan, None, None, uncorrected=uncorrected)
        posture.com_state[1:] = 0.0
        return log

    def _search(self, leg: Leg, ahead: Sequence[Step]) -> list[TickLog]:
        """Look for the floor below a foot that did not meet it, with the weight on the other feet.

        If there is none the foot goes back to where it stood.
        """
        posture, gait, late = self.posture, self._gait, self.posture.plant.late_ticks or 0
        start_m = posture.feet_m[LEGS.index(leg)]
        # A foot that is commanded late is still on its way.
        waits = late + 1 if late > 0 else 0
        curve = np.concatenate([np.repeat(start_m[None], waits, axis=0), search_swing(start_m, gait)])
        search = replace(ahead[0], shift_ticks=0, swing_ticks=len(curve), push=None)
        step, plan = self._plan([search, *ahead[1:]])
        until = self._touchdown(leg, step, 0, step.swing_ticks, stops_leg=False, blocked_tick=waits + late, late=0)
        logs = [self._move(step, plan, lambda _: curve, until)]
        if logs[-1].touched_down or logs[-1].left_plan or posture.plant.fallen:
            return logs
        self.without_floor = leg
        back_m, n_ticks = self._footholds_m[LEGS.index(leg)], gait.swing_ticks
        back = replace(search, swing_ticks=n_ticks, target_m=back_m[:2])
        swing = partial(landing_swing, end_m=back_m, height_m=gait.step_height_m, n_ticks=n_ticks, gait=gait)
        step, plan = self._plan([back, *ahead[1:]])
        return [*logs, self._move(step, plan, swing, self._touchdown(leg, step, n_ticks // 2, n_ticks, stops_leg=True))]
