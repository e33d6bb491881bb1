"""The response surface: mean displacement and residuals of many pushes."""

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent_proc.map_world.surface import ResponseSurface
from tests.agent.map_world.fake_maps import known_surface

SURFACE = known_surface()
units = st.floats(0.0, 1.0)
depths = st.floats(0.0, SURFACE.deepest_m)


def one(value: float) -> np.ndarray:
    return np.array([value])


def moved(mirror: float, depth_m: float, w1: float, w2: float, *, first: bool = False) -> list[float]:
    row: list[float] = SURFACE.displacement(one(mirror), one(depth_m), one(w1), one(w2), first=first)[0].tolist()
    return row


@given(depth_m=depths, w1=units, w2=units, first=st.booleans())
def test_the_right_leg_does_the_mirror_image_of_the_left_one(
    depth_m: float, w1: float, w2: float, *, first: bool
) -> None:
    forward, left, turn = moved(1.0, depth_m, w1, w2, first=first)

    assert moved(-1.0, depth_m, w1, w2, first=first) == [forward, -left, -turn]


def test_at_the_centre_of_the_curve_the_rows_hold_and_between_them_it_is_linear() -> None:
    rows = np.column_stack([SURFACE.forward_m, SURFACE.left_m, SURFACE.turn_rad])
    for row, depth_m in zip(rows, SURFACE.depth_m, strict=True):
        assert moved(1.0, depth_m, 0.5, 0.5) == row.tolist()
    middle = (SURFACE.depth_m[3] + SURFACE.depth_m[4]) / 2
    assert moved(1.0, middle, 0.5, 0.5) == pytest.approx(((rows[3] + rows[4]) / 2).tolist(), abs=1e-12)


def test_the_curve_adds_the_depth_times_its_polynomial() -> None:
    depth_m, w1, w2 = 0.06, 0.9, 0.2
    a, b = w1 - 0.5, w2 - 0.5
    terms = np.array([a, b, a * a, a * b, b * b])

    added = np.array(moved(1.0, depth_m, w1, w2)) - moved(1.0, depth_m, 0.5, 0.5)
    assert added == pytest.approx(depth_m * np.array(SURFACE.curve) @ terms, abs=1e-12)


def test_the_first_push_moves_the_box_farther() -> None:
    added = np.array(moved(1.0, 0.05, 0.5, 0.5, first=True)) - moved(1.0, 0.05, 0.5, 0.5)

    assert added == pytest.approx(SURFACE.first)


@pytest.mark.parametrize("depth_m", [0.004, 0.03, 0.1, 0.2])
@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_residuals_have_the_covariance_of_their_depth(depth_m: float, mirror: float) -> None:
    n = 20_000
    normal = np.random.default_rng(1).standard_normal((n, 3))
    part = next((p for p in SURFACE.residuals if depth_m <= p.to_depth_m), SURFACE.residuals[-1])
    signs = np.diag([1.0, mirror, mirror])

    drawn = SURFACE.residual(np.full(n, mirror), np.full(n, depth_m), normal)
    covariance = signs @ part.covariance @ signs
    scale = np.sqrt(np.outer(covariance.diagonal(), covariance.diagonal()))
    assert np.abs(np.cov(drawn, rowvar=False) - covariance).max() < 0.05 * scale.max()
    assert np.abs((np.cov(drawn, rowvar=False) - covariance) / scale).max() < 0.05
    assert np.abs(drawn.mean(axis=0) / np.sqrt(covariance.diagonal())).max() < 0.05


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"forward_m": (0.0, 0.1)}, "as many values of forward_m"),
        ({"depth_m": tuple(0.01 * (k + 1) for k in range(len(SURFACE.depth_m)))}, "depths that grow from 0 on"),
        ({"depth_m": (0.0,) * len(SURFACE.depth_m)}, "depths that grow from 0 on"),
    ],
)
def test_rows_that_do_not_belong_together_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=message):
        msgspec.convert(msgspec.to_builtins(SURFACE) | changes, ResponseSurface)
