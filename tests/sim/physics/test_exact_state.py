"""The exact state of the robot against what MuJoCo computes of the same posture."""

import numpy as np

from legpush.scene.conventions import JOINT_QPOS
from legpush.scene.scenario import Scenario
from sim_proc.gravity import GRAVITY_M_S2
from sim_proc.headless import mujoco
from sim_proc.physics.physics import Physics
from tests.sim.commands import held


def test_a_standing_robot_carries_its_weight_and_does_not_move(at_the_box: Scenario) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    physics.run(held(np.repeat(physics.data.qpos[JOINT_QPOS][None], 50, axis=0)))
    state = physics.body_state()
    np.testing.assert_allclose(state.loads_n.sum(), physics.mass_kg * GRAVITY_M_S2, rtol=0.01)
    np.testing.assert_allclose([*state.velocity_m_s, *state.com_velocity_m_s], 0.0, atol=1e-3)
    np.testing.assert_allclose(state.rotation @ state.rotation.T, np.eye(3), atol=1e-12)


def test_positions_and_velocities_are_those_of_the_posture(at_the_box: Scenario) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    data = physics.data
    data.qvel[:6] = [0.1, -0.2, 0.05, 0.3, 0.2, -0.1]
    mujoco.mj_forward(physics.model, data)
    state = physics.body_state()
    np.testing.assert_allclose(state.tips_m, physics.tips_m(), atol=1e-12)
    np.testing.assert_allclose(state.com_m, physics.com_m(), atol=1e-12)
    np.testing.assert_allclose(state.velocity_m_s, [0.1, -0.2, 0.05], atol=1e-12)
    arm = state.com_m - state.position_m
    expected = state.velocity_m_s + np.cross(state.angular_velocity_rad_s, arm)
    np.testing.assert_allclose(state.com_velocity_m_s, expected, atol=1e-12)
