"""Rotations, kinematics and the motion that imu and joints tell."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from legpush.scenarios.file import load_scenario
from legpush.scene.robot import RobotSpec
from sim_proc.estimation import layout, motion
from sim_proc.estimation.body import body_numbers
from sim_proc.kinematics.leg import SIDE, LegKinematics
from sim_proc.model.world import build_model
from sim_proc.physics.assumed_body import AssumedBody

VECTORS = st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3)
SEEDS = st.integers(0, 2**32 - 1)


@given(seed=SEEDS, vector=VECTORS)
@settings(max_examples=50, deadline=None)
def test_small_turns_are_those_of_scipy(seed: int, vector: list[float]) -> None:
    before = Rotation.random(random_state=seed)
    q = before.as_quat(scalar_first=True)
    motion.turn_by.py_func(q, *(0.1 * np.array(vector)))
    wanted = before * Rotation.from_rotvec(0.1 * np.array(vector))
    r = np.empty((3, 3))
    motion.rotation_matrix.py_func(q, r)
    assert r == pytest.approx(wanted.as_matrix(), abs=1e-14)
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-15)


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_feet_and_centre_of_mass_are_those_of_the_legs_and_of_mujoco(seed: int) -> None:
    scenario = load_scenario("push")
    assumed, legs = AssumedBody(build_model(scenario)), LegKinematics(scenario.robot)
    body = body_numbers(scenario.robot, np.array([0.0, 0.0, -9.81]), *assumed.moments())
    joints = np.random.default_rng(seed).uniform(legs.lower_limits_rad, legs.upper_limits_rad, (4, 3))
    tips, com, qpos = np.empty((4, 3)), np.empty(3), np.zeros(26)
    motion.kinematics.py_func(body, joints.ravel(), tips, com)
    assert tips == pytest.approx(legs.forward(joints, SIDE) + legs.hips_b, abs=1e-12)
    qpos[3], qpos[7:19] = 1.0, joints.ravel()
    assert com == pytest.approx(assumed.com_m(qpos), abs=1e-12)


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_a_tick_is_integrated_as_by_scipy(seed: int) -> None:
    random = np.random.default_rng(seed)
    state, rotation = random.normal(size=layout.N_STATE), Rotation.random(random_state=seed)
    state[layout.QUATERNION : layout.QUATERNION + 4] = rotation.as_quat(scalar_first=True)
    readings = random.normal(scale=2.0, size=(layout.STEPS, 22))
    position, velocity = state[:3].copy(), state[3:6].copy()
    gravity, means, r = np.array([0.1, 0.2, -9.8]), np.empty(6), np.empty((3, 3))
    biases = state[layout.GYRO_BIAS : layout.GYRO_BIAS + 6].copy()
    motion.propagate.py_func(state, gravity, readings, means, r)
    for row in readings:
        rotation *= Rotation.from_rotvec((row[:3] - biases[:3]) * 0.002)
        velocity += (rotation.apply(row[3:6] - biases[3:]) + gravity) * 0.002
        position += velocity * 0.002
    assert state[:3] == pytest.approx(position, abs=1e-12)
    assert state[3:6] == pytest.approx(velocity, abs=1e-12)
    assert r == pytest.approx(rotation.as_matrix(), abs=1e-12)
    assert means[3:] == pytest.approx(readings[:, :3].mean(axis=0) - biases[:3], abs=1e-12)
    assert means[:3] == pytest.approx(readings[:, 3:6].mean(axis=0) - biases[3:], abs=1e-12)


def test_a_foot_rolls_about_its_contact_when_its_shank_turns() -> None:
    robot = RobotSpec()
    state, memory, joints = np.zeros(layout.N_STATE), np.zeros(layout.N_MEMORY), np.zeros(12)
    radius, r, means = robot.legs.foot_radius_m, np.eye(3), np.zeros(6)
    joints[1], joints[2] = 0.3, 0.1
    motion.roll.py_func(state, memory, r, means, joints, 0, radius)
    # The shank turns by 0.2 rad about y, which moves the centre, above the contact, forward.
    assert state[layout.FEET : layout.FEET + 3] == pytest.approx([0.2 * radius, 0.0, 0.0])
    means[3] = 0.5 / layout.TICK_S
    memory[layout.JOINTS : layout.JOINTS + 12] = joints
    motion.roll.py_func(state, memory, r, means, joints, 0, radius)
    assert state[layout.FEET : layout.FEET + 3] == pytest.approx([0.2 * radius, -0.5 * radius, 0.0])
