"""The analytic leg kinematics against MuJoCo's own, and against themselves."""

import mujoco
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from legpush.scene.conventions import LEGS
from legpush.scene.scenario import Scenario
from sim_proc.kinematics.leg import SIDE
from sim_proc.model.world import build_model
from tests.robots import KINEMATICS, ROBOT


def random_joints(n: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(KINEMATICS.lower_limits_rad, KINEMATICS.upper_limits_rad, (n, 4, 3))


def test_forward_kinematics_equal_those_of_the_model_over_the_whole_joint_range(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    data = mujoco.MjData(model)
    sites = [model.site(f"{leg}_tip").id for leg in LEGS]
    for joints in random_joints(300):
        data.qpos[7:19] = joints.ravel()
        mujoco.mj_kinematics(model, data)
        tips_b = (data.site_xpos[sites] - data.body("trunk").xpos) @ data.body("trunk").xmat.reshape(3, 3)
        np.testing.assert_allclose(tips_b, KINEMATICS.hips_b + KINEMATICS.forward(joints, SIDE), atol=1e-12)


def test_inverse_kinematics_reach_every_tip_of_the_joint_range_inside_the_limits() -> None:
    joints = random_joints(20_000)
    tips = KINEMATICS.forward(joints, SIDE)
    found = KINEMATICS.inverse(tips, SIDE)
    np.testing.assert_allclose(KINEMATICS.forward(found, SIDE), tips, atol=1e-9)
    assert (found >= KINEMATICS.lower_limits_rad - 1e-9).all()
    assert (found <= KINEMATICS.upper_limits_rad + 1e-9).all()


def test_inverse_kinematics_give_back_the_joints_where_the_foot_is_below_the_hip() -> None:
    joints = random_joints(20_000, seed=1)
    below = (
        ROBOT.legs.upper_length_m * np.cos(joints[..., 1])
        + ROBOT.legs.lower_length_m * np.cos(joints[..., 1] - joints[..., 2])
        > 1e-3
    )
    assert below.mean() > 0.8
    found = KINEMATICS.inverse(KINEMATICS.forward(joints, SIDE), SIDE)
    np.testing.assert_allclose(found[below], joints[below], atol=1e-6)


def test_a_tip_out_of_reach_is_nan_unless_the_leg_may_saturate() -> None:
    far = np.array([0.5, 0.111, -0.7])
    assert np.isnan(KINEMATICS.inverse(far, 1.0)).any()
    stretched = KINEMATICS.inverse(far, 1.0, saturate=True)
    assert np.isfinite(stretched).all()
    tip = KINEMATICS.forward(stretched, 1.0)
    assert np.linalg.norm(far - tip) < np.linalg.norm(far - KINEMATICS.forward(KINEMATICS.inverse(0.5 * far, 1.0), 1.0))


points = st.tuples(*[st.floats(-0.9, 0.9)] * 3).map(np.array)


@given(points, points, st.sampled_from([-1.0, 1.0]))
@settings(max_examples=300, deadline=None)
def test_joint_angles_never_jump_while_a_tip_moves_anywhere(start: np.ndarray, end: np.ndarray, side: float) -> None:
    """Where the angles change fastest, steps are made smaller and smaller: a jump would stay."""
    step = np.inf
    for _ in range(12):
        way = start + (end - start) * np.linspace(0.0, 1.0, 200)[:, None]
        joints = KINEMATICS.inverse(way, side, saturate=True)
        steps = np.abs(np.diff(joints, axis=0)).max(axis=1)
        place = int(steps.argmax())
        start, end, step = way[place], way[place + 1], float(steps[place])
        if step < 0.01:
            return
    raise AssertionError(f"a joint jumps by {step:.3f} rad at {start}")


def test_a_leg_that_may_saturate_reaches_what_it_reaches_with_the_foot_below_the_hip() -> None:
    joints = random_joints(20_000, seed=2)
    tips = KINEMATICS.forward(joints, SIDE)
    upper, lower = ROBOT.legs.upper_length_m, ROBOT.legs.lower_length_m
    below = upper * np.cos(joints[..., 1]) + lower * np.cos(joints[..., 1] - joints[..., 2]) > 2e-3
    found = KINEMATICS.forward(KINEMATICS.inverse(tips, SIDE, saturate=True), SIDE)
    assert below.mean() > 0.8
    np.testing.assert_allclose(found[below], tips[below], atol=1e-9)


@given(st.integers(0, 2**31), st.integers(0, 3))
def test_the_jacobian_is_the_derivative_of_forward_kinematics(seed: int, leg: int) -> None:
    joints = random_joints(1, seed)[0, leg]
    step = 1e-6 * np.eye(3)
    slopes = [
        (KINEMATICS.forward(joints + d, SIDE[leg]) - KINEMATICS.forward(joints - d, SIDE[leg])) / 2e-6 for d in step
    ]
    np.testing.assert_allclose(KINEMATICS.jacobian(joints, SIDE[leg]), np.stack(slopes, axis=-1), atol=1e-8)


def test_left_and_right_legs_mirror_each_other() -> None:
    joints = random_joints(1000)[:, 0]
    mirrored = joints * [-1.0, 1.0, 1.0]
    np.testing.assert_allclose(
        KINEMATICS.forward(joints, 1.0) * [1.0, -1.0, 1.0], KINEMATICS.forward(mirrored, -1.0), atol=1e-12
    )


def test_the_robot_stands_with_its_feet_on_the_floor_at_the_corners_of_the_rectangle() -> None:
    joints = KINEMATICS.standing_joints_rad()
    tips = KINEMATICS.hips_b + KINEMATICS.forward(joints, SIDE)
    np.testing.assert_allclose(tips[:, :2], ROBOT.stance.foot_rectangle_b(), atol=1e-12)
    np.testing.assert_allclose(tips[:, 2] + ROBOT.stance.height_m, ROBOT.legs.foot_radius_m)
    assert ((joints > KINEMATICS.lower_limits_rad) & (joints < KINEMATICS.upper_limits_rad)).all()
