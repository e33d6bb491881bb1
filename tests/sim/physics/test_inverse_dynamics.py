"""Torques of planned motions, against MuJoCo's own inverse dynamics of the whole model."""

from math import cos, sin

import mujoco
import numpy as np

from legpush.scene.conventions import JOINT_QPOS
from legpush.scene.scenario import Scenario
from sim_proc.control.joint_commands import Knots
from sim_proc.model.world import JOINT_QVEL, build_model
from sim_proc.physics.inverse_dynamics import InverseDynamics


def test_torques_are_those_of_mujoco_for_a_robot_in_the_air(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    dynamics = InverseDynamics(model, at_the_box.robot)
    rng = np.random.default_rng(0)
    joints = np.array([0.1, 0.7, 1.3] * 4) + 0.1 * rng.normal(size=(4, 12))
    motion = Knots(
        positions_rad=joints, velocities_rad_s=rng.normal(size=(4, 12)), accelerations_rad_s2=rng.normal(size=(4, 12))
    )
    torques = dynamics.torques_n_m(motion, np.array([0.3, 0.4, 0.5]))
    data = mujoco.MjData(model)
    for row, yaw in enumerate((0.3, 0.4, 0.5)):
        data.qpos[:7] = [1.0, 1.0, 5.0, cos(yaw / 2), 0.0, 0.0, sin(yaw / 2)]
        data.qpos[JOINT_QPOS] = motion.positions_rad[row + 1]
        data.qvel[JOINT_QVEL] = motion.velocities_rad_s[row + 1]
        data.qacc[:] = 0.0
        data.qacc[JOINT_QVEL] = motion.accelerations_rad_s2[row + 1]
        mujoco.mj_inverse(model, data)
        np.testing.assert_allclose(torques[row], data.qfrc_inverse[JOINT_QVEL], atol=1e-6)
