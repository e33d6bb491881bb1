"""The observation that the simulator reports: the world after a step, and the trace of its ticks."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import rpy_from_quaternion
from legpush.messages.stepping import BoxState, Imu, PathProgress, PushReport, Trace, TrunkState, WorldState
from legpush.scene.conventions import BOX_QPOS, JOINT_QPOS, LOADED_N, TRUNK_QPOS
from sim_proc.control.balance import support_margin
from sim_proc.control.plant import TickLog
from sim_proc.model.world import JOINT_QVEL
from sim_proc.physics.physics import Physics


def world_state(physics: Physics, n_footsteps: int, path: PathProgress | None, push: PushReport | None) -> WorldState:
    """The present state of the world, after `n_footsteps` steps of the robot."""
    qpos, qvel = physics.data.qpos, physics.data.qvel
    trunk, box = qpos[TRUNK_QPOS], qpos[BOX_QPOS]
    return WorldState(
        tick=physics.tick,
        trunk=TrunkState(
            position_m=_plain(trunk[:3]),
            orientation_wxyz=_plain(trunk[3:]),
            linear_velocity_m_s=_plain(qvel[:3]),
            angular_velocity_rad_s=_plain(physics.trunk_angular_velocity_rad_s()),
        ),
        joint_positions_rad=_plain(qpos[JOINT_QPOS]),
        joint_velocities_rad_s=_plain(qvel[JOINT_QVEL]),
        tips_m=_plain(physics.tips_m()),
        foot_forces_n=_plain(np.linalg.norm(physics.floor_forces_n() + physics.box_forces_n(), axis=1)),
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
    )


def trace(logs: Sequence[TickLog], last_tick: int, downhill: Floats) -> Trace:
    """Join the logs of one step into its trace, whose last row is `last_tick`.

    `downhill` is that of the plant, (2,). The zero-moment point is the centre of pressure of the feet. A robot that no
    foot carries has none, and its place is taken by the ground projection of the centre of mass.
    """
    if not logs:
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
    qpos, tips, com = (np.concatenate([getattr(log, name) for log in logs]) for name in ("qpos", "tips_m", "com_m"))
    floor = np.concatenate([log.floor_forces_n for log in logs])
    box = np.concatenate([log.box_forces_n for log in logs])
    load = floor[:, :, 2]
    total = load.sum(axis=1, keepdims=True)
    pressure = (load[:, :, None] * tips[:, :, :2]).sum(axis=1) / np.maximum(total, LOADED_N)
    zmp = np.where(total >= LOADED_N, pressure, com[:, :2])
    return Trace(
        tick=tuple(range(last_tick - len(qpos) + 1, last_tick + 1)),
        qpos=_plain(qpos),
        roll_pitch_rad=_plain(rpy_from_quaternion(qpos[:, 3:7])[:, :2]),
        tips_m=_plain(tips),
        contact_forces_n=_plain(floor + box),
        com_m=_plain(com),
        zmp_m=_plain(zmp),
        support_margin_m=_plain(support_margin(com[:, :2] + com[:, 2:] * downhill, tips[:, :, :2], load >= LOADED_N)),
    )


def _plain(array: Floats) -> Any:
    """An array as nested tuples of floats, the form that messages hold."""
    return _tuples(array.tolist())


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
