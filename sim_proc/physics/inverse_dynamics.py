"""Inverse dynamics of a planned motion of the joints, by MuJoCo's recursive Newton-Euler algorithm."""

from math import cos, sin

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import JOINT_QPOS, LEGS, TRUNK_QPOS
from legpush.scene.robot import RobotSpec
from sim_proc.control.joint_commands import Knots
from sim_proc.headless import mujoco
from sim_proc.model.world import JOINT_QVEL


class InverseDynamics:
    """Torques of planned joint motions. The trunk is level and at rest, and nothing touches the feet."""

    def __init__(self, model: mujoco.MjModel, robot: RobotSpec) -> None:
        """Use the masses and the gravity of `model`."""
        self._model, self._data = model, mujoco.MjData(model)
        self._forces = np.empty(model.nv)
        joints = robot.joints.in_order()
        self._armature = np.array(len(LEGS) * [joint.armature_kg_m2 for joint in joints])
        self._damping = np.array(len(LEGS) * [joint.damping_n_m_s_rad for joint in joints])

    def torques_n_m(self, motion: Knots, yaw_rad: Floats) -> Floats:
        """Torques at all knots but the first, (n, 12), with the trunk turned by `yaw_rad` (n,)."""
        model, data, forces = self._model, self._data, self._forces
        orientation, joints, joint_forces = data.qpos[TRUNK_QPOS][3:], data.qpos[JOINT_QPOS], forces[JOINT_QVEL]
        joint_velocities, joint_accelerations = data.qvel[JOINT_QVEL], data.qacc[JOINT_QVEL]
        positions, velocities, accelerations = (
            rows[1:] for rows in (motion.positions_rad, motion.velocities_rad_s, motion.accelerations_rad_s2)
        )
        kinematics, com_pos, com_vel, rne = mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel, mujoco.mj_rne
        torques = np.empty_like(positions)
        for k, yaw in enumerate(yaw_rad.tolist()):
            orientation[0], orientation[3] = cos(yaw / 2), sin(yaw / 2)
            joints[:] = positions[k]
            joint_velocities[:] = velocities[k]
            joint_accelerations[:] = accelerations[k]
            kinematics(model, data)
            com_pos(model, data)
            com_vel(model, data)
            rne(model, data, 1, forces)
            torques[k] = joint_forces
        return torques + self._armature * accelerations + self._damping * velocities
