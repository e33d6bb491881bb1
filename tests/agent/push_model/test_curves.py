"""Curves of the effect of pushes over their depth, which follow what pushes do."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent_proc.push_model.curves import Curves, Part, Spread
from legpush.arrays import Floats

DEPTH_M = np.array([0.0, 0.02, 0.05, 0.1])
EXPECTED = np.array([0.0, 0.02, 0.04, 0.07])
COMMON = Part(sd=0.02, power=1.0, reach_m=0.1)
OPPOSITE = Part(sd=0.005, power=1.0, reach_m=0.1)
SPREAD = Spread(common=COMMON, opposite=OPPOSITE, noise=0.001, deep_noise=0.002, noise_power=2.0)


def new() -> Curves:
    return Curves(DEPTH_M, EXPECTED, SPREAD)


def test_before_the_first_push_both_legs_do_what_is_expected_and_shallow_pushes_are_known_best() -> None:
    curves = new()
    np.testing.assert_allclose(curves.values(), [EXPECTED, EXPECTED])
    assert (np.diff(curves.sd()) > 0.0).all()
    np.testing.assert_allclose(curves.sd()[:, 0], SPREAD.noise)


@given(
    first=st.lists(st.floats(-0.02, 0.06), min_size=3, max_size=3),
    second=st.lists(st.floats(-0.02, 0.06), min_size=3, max_size=3),
)
def test_pushes_at_all_depths_show_any_curves(first: list[float], second: list[float]) -> None:
    curves = new()
    for _ in range(40):
        for leg, measured in enumerate((first, second)):
            for depth_m, value in zip(DEPTH_M[1:].tolist(), measured, strict=True):
                curves.learn(leg, np.array([depth_m]), np.array([value]))

    np.testing.assert_allclose(curves.values()[:, 1:], [first, second], atol=0.004)


def test_a_push_says_more_of_near_depths_and_of_its_own_leg() -> None:
    curves = new()
    curves.learn(0, np.array([0.05]), np.array([0.02]))
    less: Floats = 1.0 - curves.values()[:, 1:] / EXPECTED[1:]

    assert curves.values()[0, 2] == pytest.approx(0.02, abs=0.002)
    assert (less > 0.0).all()
    assert (less[0] > less[1]).all()
    assert curves.sd()[0, 2] < curves.sd()[0, 3] < new().sd()[0, 3]
    assert curves.sd()[0, 2] < curves.sd()[1, 2]


@given(depth_m=st.floats(0.001, 0.15), off=st.floats(0.005, 0.05))
def test_what_is_expected_is_most_likely(depth_m: float, off: float) -> None:
    expected = float(np.interp(depth_m, DEPTH_M, EXPECTED))
    depths_m = np.array([depth_m])
    near, far = (new().learn(0, depths_m, np.array([effect])) for effect in (expected, expected + off))
    assert near > far


def test_a_push_of_no_depth_says_nothing() -> None:
    curves = new()
    curves.learn(1, np.array([0.0]), np.array([0.03]))
    np.testing.assert_allclose(curves.values(), [EXPECTED, EXPECTED])


def test_fits_with_other_depths_are_those_of_curves_of_their_own() -> None:
    depths_m = np.array([0.01, 0.04, 0.09])
    together = Curves(DEPTH_M, EXPECTED, SPREAD, len(depths_m))
    alone = [new() for _ in depths_m]
    for leg, deeper_m, measured in ((0, 0.0, 0.03), (1, 0.01, 0.02), (0, 0.02, 0.05)):
        found = together.learn(leg, depths_m + deeper_m, np.full(3, measured))
        expected = [
            each.learn(leg, np.array([depth_m]), np.array([measured]))
            for each, depth_m in zip(alone, (depths_m + deeper_m).tolist(), strict=True)
        ]
        assert found.tolist() == [float(each[0]) for each in expected]

    for fit, each in enumerate(alone):
        assert together.values(fit).tolist() == each.values().tolist()
        assert together.sd(fit).tolist() == each.sd().tolist()
