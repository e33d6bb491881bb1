"""Quaternions and frames, against rotations that are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.arrays import Floats
from legpush.scene.conventions import N_QPOS
from legpush.scene.scenario import Scenario
from sim_proc.export.transforms import moving_frames, product, standing_frames, turn_to
from sim_proc.model.shapes import parts_of

QUARTER = np.sqrt(0.5)
coordinate = st.floats(-2.0, 2.0)


def turned(quaternion_wxyz: Floats, vector: Floats) -> Floats:
    """A vector, turned by a quaternion."""
    conjugate = quaternion_wxyz * np.array([1.0, -1.0, -1.0, -1.0])
    once = product(quaternion_wxyz[None], np.array([[0.0, *vector]]))
    result: Floats = product(once, conjugate[None])[0, 1:]
    return result


def test_a_product_turns_by_the_second_first() -> None:
    about_x, about_z = np.array([QUARTER, QUARTER, 0.0, 0.0]), np.array([QUARTER, 0.0, 0.0, QUARTER])
    both = product(about_z[None], about_x[None])[0]
    np.testing.assert_allclose(turned(both, np.array([0.0, 1.0, 0.0])), [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(turned(both, np.array([0.0, 0.0, 1.0])), [1.0, 0.0, 0.0], atol=1e-12)


@given(coordinate, coordinate, coordinate)
def test_the_x_axis_is_turned_into_any_direction(x: float, y: float, z: float) -> None:
    direction = np.array([x, y, z])
    length = np.linalg.norm(direction)
    quaternion = turn_to(direction)
    assert np.linalg.norm(quaternion) == pytest.approx(1.0)
    if length > 1e-3:
        np.testing.assert_allclose(turned(quaternion, np.array([1.0, 0.0, 0.0])), direction / length, atol=1e-6)


@pytest.mark.parametrize("direction", [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-3.0, 0.0, 0.0]])
def test_directions_along_the_axis_are_no_special_case_for_the_caller(direction: list[float]) -> None:
    x, *_ = turned(turn_to(np.array(direction)), np.array([1.0, 0.0, 0.0]))
    assert x == pytest.approx(-1.0 if direction[0] < 0.0 else 1.0)


def test_frames_move_if_a_joint_moves_them_and_stand_otherwise(at_the_box: Scenario) -> None:
    parts = parts_of(at_the_box)
    qpos = np.random.default_rng(0).uniform(-1.0, 1.0, (5, N_QPOS))
    moving = {frame.name: frame for frame in moving_frames(parts, qpos)}
    standing = {frame.name for frame in standing_frames(parts)}
    assert len(moving) == 14
    assert standing == {"goal"}
    np.testing.assert_array_equal(moving["trunk"].positions_m, qpos[:, :3])
    np.testing.assert_array_equal(moving["box"].quaternions_wxyz, qpos[:, 22:])
    np.testing.assert_allclose(moving["FL_hip"].quaternions_wxyz[:, 1], np.sin(qpos[:, 7] / 2))
