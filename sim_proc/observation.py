"""The observation that the simulator reports: the world after a step, and the trace of its ticks."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import rpy_from_quaternion
from legpush.messages.stepping import BoxState, Imu, PathProgress, Perceived, PushReport, Trace, TrunkState, WorldState
from legpush.scene.conventions import BOX_QPOS, JOINT_QPOS, TRUNK_QPOS
from sim_proc.control.plant import TickLog
from sim_proc.measures.motion import Measured
from sim_proc.measures.stability import zero_moment_points
from sim_proc.model.world import JOINT_QVEL
from sim_proc.physics.physics import Physics

OF_STEPS: Final = (
    "joint_velocities_rad_s",
    "joint_torques_n_m",
    "trunk_velocity_m_s",
    "imu_angular_velocity_rad_s",
    "imu_acceleration_m_s2",
)
"""Fields of a trace that are those of the last physics step of each tick."""


def world_state(
    physics: Physics,
    n_footsteps: int,
    path: PathProgress | None,
    push: PushReport | None,
    perceived: Perceived | None,
) -> WorldState:
    """The present state of the world, after `n_footsteps` steps of the robot, and what is known of it."""
    qpos, qvel = physics.data.qpos, physics.data.qvel
    trunk, box = qpos[TRUNK_QPOS], qpos[BOX_QPOS]
    return WorldState(
        tick=physics.tick,
        trunk=TrunkState(
            position_m=_plain(trunk[:3]),
            orientation_wxyz=_plain(trunk[3:]),
            linear_velocity_m_s=_plain(qvel[:3]),
            angular_velocity_rad_s=_plain(physics.body_state().angular_velocity_rad_s),
        ),
        joint_positions_rad=_plain(qpos[JOINT_QPOS]),
        joint_velocities_rad_s=_plain(qvel[JOINT_QVEL]),
        tips_m=_plain(physics.tips_m()),
        foot_forces_n=_plain(np.linalg.norm(physics.foot_forces_n(), axis=1)),
        imu=Imu(
            orientation_wxyz=_plain(physics.sensor("imu_orientation")),
            angular_velocity_rad_s=_plain(physics.sensor("imu_angular_velocity")),
            linear_acceleration_m_s2=_plain(physics.sensor("imu_acceleration")),
        ),
        box=BoxState(position_m=_plain(box[:3]), orientation_wxyz=_plain(box[3:])),
        n_footsteps=n_footsteps,
        fallen=physics.fallen,
        path=path,
        push=push,
        appeared=physics.appeared,
        perceived=perceived,
    )


def trace(logs: Sequence[TickLog], last_tick: int, measured: Measured | None) -> Trace:
    """Join the logs of one step into its trace, whose last row is `last_tick`.

    `measured` is what was measured of these logs; None if there are none.
    """
    if measured is None:
        return Trace(
            tick=(),
            qpos=(),
            roll_pitch_rad=(),
            tips_m=(),
            contact_forces_n=(),
            com_m=(),
            zmp_m=(),
            support_margin_m=(),
        )
    qpos, tips, com, floor, box = (
        np.concatenate([getattr(log, name) for log in logs])
        for name in ("qpos", "tips_m", "com_m", "floor_forces_n", "box_forces_n")
    )
    of_steps = {name: _plain(np.concatenate([getattr(log.steps, name)[:, -1] for log in logs])) for name in OF_STEPS}
    return Trace(
        tick=tuple(range(last_tick - len(qpos) + 1, last_tick + 1)),
        qpos=_plain(qpos),
        roll_pitch_rad=_plain(rpy_from_quaternion(qpos[:, 3:7])[:, :2]),
        tips_m=_plain(tips),
        contact_forces_n=_plain(floor + box),
        com_m=_plain(com),
        zmp_m=_plain(zero_moment_points(tips, floor[:, :, 2], com)),
        support_margin_m=_plain(measured.margins_m.support_m),
        zmp_margin_m=_plain(measured.margins_m.zmp_m),
        capture_margin_m=_plain(measured.margins_m.capture_m),
        foot_moment_n_m=_plain(measured.moments_n_m),
        **of_steps,
    )


def _plain(array: Floats) -> Any:
    """An array as nested tuples of floats, the form that messages hold."""
    return _tuples(array.tolist())


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
