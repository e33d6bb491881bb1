"""The Kalman filter's arithmetic against numbers of numpy and finite differences."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from legpush.arrays import Floats
from sim_proc.estimation import filtering, layout, motion

N, STEP = layout.N_ERRORS, 1e-6


def random_state(seed: int) -> Floats:
    random = np.random.default_rng(seed)
    state = random.normal(size=layout.N_STATE)
    quaternion = Rotation.random(random_state=seed).as_quat(scalar_first=True)
    state[layout.QUATERNION : layout.QUATERNION + 4] = quaternion
    state[layout.GYRO_BIAS : layout.FEET] *= 0.01
    return state


def random_covariance(seed: int) -> Floats:
    root = np.random.default_rng(seed).normal(size=(N, N))
    covariance: Floats = root @ root.T / N
    return covariance


def matrix(state: Floats) -> Floats:
    r = np.empty((3, 3))
    motion.rotation_matrix.py_func(state[layout.QUATERNION : layout.QUATERNION + 4], r)
    return r


def derivative(function: Callable[[Floats], Floats], state: Floats) -> Floats:
    """Derivative of a function of the state by errors, (m, 27), by central differences."""
    columns = []
    for k in range(N):
        ends = []
        for sign in (1.0, -1.0):
            change, moved = np.zeros(N), state.copy()
            change[k] = sign * STEP
            filtering.correct.py_func(moved, change)
            ends.append(function(moved))
        columns.append((ends[0] - ends[1]) / (2 * STEP))
    return np.column_stack(columns)


def test_the_transition_of_errors_is_the_derivative_of_the_motion() -> None:
    state = random_state(0)
    reading = np.r_[np.random.default_rng(0).normal(scale=0.5, size=3), 0.5, -0.3, 9.8, np.zeros(16)]
    readings, gravity, means, r = (
        np.tile(reading, (layout.STEPS, 1)),
        np.array([0.0, 0.0, -9.81]),
        np.empty(6),
        np.eye(3),
    )
    after = state.copy()
    motion.propagate.py_func(after, gravity, readings, means, r)
    end = matrix(after)

    def error_after(moved: Floats) -> Floats:
        motion.propagate.py_func(moved, gravity, readings, np.empty(6), np.eye(3))
        turn = Rotation.from_matrix(end.T @ matrix(moved)).as_rotvec()
        error: Floats = np.r_[moved[:6] - after[:6], turn]
        return error

    f = np.empty((9, 15))
    filtering.error_transition.py_func(r, means, f)
    wanted = derivative(error_after, state)
    assert (wanted[:, 15:] == 0.0).all()
    # Within a tick, position and velocity feel an attitude that is not yet that of its end: some hundredths.
    assert f[:, 3:6] == pytest.approx(wanted[:, 3:6], abs=1e-7)
    assert f[3:] == pytest.approx(wanted[3:, :15], abs=6e-3)
    assert f[6:] == pytest.approx(wanted[6:, :15], abs=2e-4)


def test_the_derivative_of_a_foothold_is_that_of_finite_differences() -> None:
    state, leg = random_state(1), 2
    foot = slice(layout.FEET + 3 * leg, layout.FEET + 3 * leg + 3)

    def offset(moved: Floats) -> Floats:
        offset_b: Floats = matrix(moved).T @ (moved[foot] - moved[:3])
        return offset_b

    wanted, h = derivative(offset, state), np.empty(9)
    columns = [0, 1, 2, 6, 7, 8, 21, 22, 23]
    for i in range(3):
        filtering.foothold_derivative.py_func(matrix(state), offset(state), i, h)
        assert h == pytest.approx(wanted[i, columns], abs=1e-8)
        assert np.delete(wanted[i], columns) == pytest.approx(0.0, abs=1e-8)


def test_spreading_is_that_of_whole_matrices() -> None:
    covariance, f = random_covariance(0), np.random.default_rng(1).normal(size=(9, 15))
    f[0, 7] = 0.0
    whole = np.eye(N)
    whole[:9, :15] = f
    wanted = whole @ covariance @ whole.T
    down = np.array([3.0, 0.0, 1.0, 0.0])
    filtering.spread.py_func(covariance, f, np.empty((9, N)), down)
    noise = np.diag(covariance - wanted)
    assert (covariance == covariance.T).all()
    assert covariance - np.diag(noise) == pytest.approx(wanted, abs=1e-12)
    assert (noise[:15] > 0.0).all()
    assert noise[15:].reshape(4, 3) == pytest.approx(np.outer([1, 0, 1, 0], np.full(3, filtering.SLIP_VARIANCE)))


def test_an_update_is_that_of_a_kalman_filter() -> None:
    covariance, change, leg = random_covariance(2), np.random.default_rng(2).normal(size=N), 1
    h, before = np.random.default_rng(3).normal(size=9), change.copy()
    row = np.zeros(N)
    row[[0, 1, 2, 6, 7, 8, 18, 19, 20]] = h
    variance = row @ covariance @ row + filtering.KINEMATICS_VARIANCE
    gain = covariance @ row / variance
    wanted = covariance - np.outer(gain, row @ covariance)
    filtering.update.py_func(covariance, h, leg, 0.3, change, np.empty(N))
    assert covariance == pytest.approx(wanted, abs=1e-12)
    assert change == pytest.approx(before + gain * (0.3 - row @ before), abs=1e-12)


def test_a_foot_that_is_placed_errs_with_the_trunk() -> None:
    state, covariance, leg, tip = random_state(4), random_covariance(4), 3, np.array([-0.3, -0.2, -0.4])
    foot = slice(layout.F + 3 * leg, layout.F + 3 * leg + 3)

    def place(moved: Floats) -> Floats:
        foot_m: Floats = moved[:3] + matrix(moved) @ tip
        return foot_m

    of_trunk = derivative(place, state)
    wanted = covariance.copy()
    whole = np.eye(N)
    whole[foot] = of_trunk
    wanted = whole @ covariance @ whole.T
    wanted[foot, foot] += np.eye(3) * filtering.FOOTHOLD_VARIANCE
    filtering.place_foot.py_func(state, covariance, matrix(state), tip, leg, np.empty((3, N)))
    assert state[layout.FEET + 3 * leg :] == pytest.approx(place(state))
    assert covariance == pytest.approx(wanted, abs=1e-7)
    assert (covariance == covariance.T).all()
