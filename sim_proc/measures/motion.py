"""The measures of a motion, from the logs of its physics steps."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from legpush.arrays import Floats
from legpush.messages.measures import MAX_LANDINGS, Measures, UnexpectedContact
from legpush.scene.conventions import LOADED_N
from legpush.scene.robot import RobotSpec
from sim_proc.control.plant import TickLog, joined_steps
from sim_proc.measures.joints import JointMeter
from sim_proc.measures.loads import LoadWatch
from sim_proc.measures.stability import Margins, foot_moments_n_m, margins


@dataclass(frozen=True, kw_only=True)
class Measured:
    """What was measured of a motion of n ticks."""

    measures: Measures
    margins_m: Margins
    """Least margins over the steps of each tick, (n,) each."""
    moments_n_m: Floats
    """Moments of the feet about the centre of mass in the last step of each tick, (n, 3)."""


class Meter:
    """Measures one motion after the other. The loads of the feet are followed from motion to motion."""

    def __init__(self, robot: RobotSpec, downhill: Floats) -> None:
        """Measure a robot on a floor with this slope, see `Plant.downhill`, (2,)."""
        self._robot, self._downhill = robot, downhill
        self._loads = LoadWatch(robot)
        self._joints = JointMeter(robot)

    def measure(
        self,
        logs: Sequence[TickLog],
        *,
        n_footsteps: int,
        n_unexpected_steps: int = 0,
        unexpected: tuple[UnexpectedContact, ...] = (),
    ) -> Measured:
        """Measure a motion with at least one log."""
        steps = joined_steps([log.steps for log in logs])
        shape = steps.com_m.shape[:2]
        tips, floor, box = (
            values.reshape(-1, 4, 3) for values in (steps.tips_m, steps.floor_forces_n, steps.box_forces_n)
        )
        heights = tips[:, :, 2]
        loads = self._loads.take(floor[:, :, 2], heights)
        of_steps = margins(steps, loads.loaded, self._downhill, self._robot)
        radius_m = self._robot.legs.foot_radius_m
        moments = foot_moments_n_m(tips, floor, box, steps.com_m.reshape(-1, 3), radius_m)
        pressed = (np.einsum("nli,nli->nl", box, box) >= LOADED_N * LOADED_N).any(axis=1)
        joints = self._joints.measure(
            *(
                values.reshape(-1, 12)
                for values in (steps.joint_positions_rad, steps.joint_velocities_rad_s, steps.joint_torques_n_m)
            )
        )
        speeds = loads.landing_speeds_m_s
        if len(speeds) > MAX_LANDINGS:
            speeds = np.sort(speeds)[-MAX_LANDINGS:]
        measures = Measures(
            n_steps=shape[0] * shape[1],
            n_footsteps=n_footsteps,
            max_torques_n_m=tuple(joints.max_torques_n_m.tolist()),
            max_speeds_rad_s=tuple(joints.max_speeds_rad_s.tolist()),
            max_powers_w=tuple(joints.max_powers_w.tolist()),
            n_at_torque_limit=tuple(joints.n_at_limit.tolist()),
            least_to_limits_rad=tuple(joints.least_to_limits_rad.tolist()),
            torque_counts=tuple(map(tuple, joints.torque_counts.tolist())),
            positive_work_j=joints.positive_work_j,
            min_support_margin_m=float(of_steps.support_m.min()),
            n_outside_support=int(np.count_nonzero(of_steps.support_m < 0.0)),
            min_zmp_margin_m=float(of_steps.zmp_m.min()),
            min_capture_margin_m=float(of_steps.capture_m.min()),
            max_push_moment_n_m=float(np.hypot(*moments[pressed, :2].T).max()) if pressed.any() else None,
            n_touchdowns=loads.n_touchdowns,
            n_loadings=loads.n_loadings,
            landing_speeds_m_s=tuple(speeds.tolist()),
            max_penetration_m=max(radius_m - float(heights.min()), 0.0),
            n_unexpected_steps=n_unexpected_steps,
            unexpected=unexpected,
        )
        return Measured(
            measures=measures,
            margins_m=Margins(
                support_m=of_steps.support_m.reshape(shape).min(axis=1),
                zmp_m=of_steps.zmp_m.reshape(shape).min(axis=1),
                capture_m=of_steps.capture_m.reshape(shape).min(axis=1),
            ),
            moments_n_m=moments.reshape(*shape, 3)[:, -1],
        )
