"""Curves of a foot in the air."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.control.swing import bezier, control_points, gentle_stop, landing_swing, minimum_jerk
from tests.robots import ROBOT

unit = st.floats(0.0, 1.0)


@pytest.mark.parametrize("profile", [minimum_jerk, gentle_stop])
def test_progress_rises_from_zero_to_one_and_stops_there(profile: object) -> None:
    assert callable(profile)
    progress = profile(500)
    assert progress[-1] == 1.0
    assert progress[0] < 1e-4
    assert (np.diff(progress) > 0).all()
    assert (progress[-1] - progress[-2]) * 500 < 0.01


def test_a_gentle_stop_never_decelerates_faster_than_it_says() -> None:
    n = 1000
    acceleration = np.diff(gentle_stop(n), 2) * n**2
    assert acceleration.min() == pytest.approx(-4.0, abs=0.02)
    assert (np.diff(minimum_jerk(n), 2) * n**2).min() < -5.7


@given(st.floats(-0.3, 0.3), st.floats(0.02, 0.2), st.floats(0.02, 0.1), st.integers(11, 60))
def test_a_swing_peaks_where_it_should_and_lands_slowly(
    along_m: float, start_z_m: float, height_m: float, n: int
) -> None:
    gait = ROBOT.gait
    start, end = np.array([1.0, 2.0, start_z_m]), np.array([1.0 + along_m, 2.1, 0.019])
    curve = landing_swing(start, end, height_m, n, gait)
    np.testing.assert_allclose(curve[-1], end)
    lands_m = gait.landing_speed_m_s * gait.landing_ticks * CONTROL_PERIOD_S
    highest_m = max(start_z_m + height_m, 0.019 + height_m, 0.019 + lands_m)
    assert highest_m - 0.002 < curve[:, 2].max() < highest_m + 0.004
    landing = np.diff(curve[-gait.landing_ticks - 1 :], axis=0) / CONTROL_PERIOD_S
    np.testing.assert_allclose(landing[:, 2], -gait.landing_speed_m_s)
    np.testing.assert_allclose(curve[-1, :2], curve[-2, :2], atol=0.02 * abs(along_m) + 0.01)


def test_a_swing_is_smooth() -> None:
    n = 1300
    gait = replace(ROBOT.gait, landing_ticks=400, landing_speed_m_s=0.1 / 100)
    curve = landing_swing([1.0, 2.0, 0.02], [1.4, 2.1, 0.019], 0.05, n, gait)
    assert curve[:, 2].max() == pytest.approx(0.07, abs=1e-4)
    assert np.abs(np.diff(curve, 2, axis=0)).max() < 1e-5


def test_the_bezier_curve_of_equation_14_begins_at_p0_and_ends_at_p3_along_its_polygon() -> None:
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.2], [0.1, 0.0, 0.3], [0.3, 0.1, 0.2]])
    curve = bezier(points, np.linspace(0, 1, 2001))
    np.testing.assert_allclose(curve[[0, -1]], points[[0, 3]])
    np.testing.assert_allclose((curve[1] - curve[0]) * 2000, 3 * (points[1] - points[0]), atol=2e-3)
    np.testing.assert_allclose(bezier(points, [0.5])[0], points.T @ [0.125, 0.375, 0.375, 0.125])


@pytest.mark.parametrize("weights", [(), (0.5,), (0.3, 0.6), (0.2, 0.4, 0.6), (0.2, 0.4, 0.6, 0.8)])
def test_a_curve_of_any_degree_leads_from_p0_to_the_last_point_within_its_control_points(
    weights: tuple[float, ...],
) -> None:
    p0, end = np.array([0.0, 0.1, 0.02]), np.array([0.25, 0.15, 0.2])
    points = control_points(p0, end, weights, "swing", 0.02)
    curve = bezier(points, np.linspace(0, 1, 101))
    assert len(points) == len(weights) + 2
    np.testing.assert_allclose(curve[[0, -1]], [p0, end], atol=1e-15)
    assert (curve >= points.min(axis=0) - 1e-12).all()
    assert (curve <= points.max(axis=0) + 1e-12).all()


def test_a_curve_without_inner_control_points_is_the_chord() -> None:
    p0, end = np.array([0.0, 0.1, 0.02]), np.array([0.25, 0.15, 0.2])
    t = np.linspace(0, 1, 11)
    curve = bezier(control_points(p0, end, (), "swing", 0.02), t)
    np.testing.assert_allclose(curve, p0 + t[:, None] * (end - p0), atol=1e-15)


def test_the_cubic_curve_has_the_bits_of_its_four_written_out_terms() -> None:
    points = np.random.default_rng(0).normal(size=(4, 3))
    t = np.linspace(0, 1, 997)
    terms = np.stack([(1 - t) ** 3, 3 * (1 - t) ** 2 * t, 3 * (1 - t) * t**2, t**3], axis=-1)
    assert (bezier(points, t) == terms @ points).all()


@given(unit, unit, st.sampled_from(["swing", "published"]))
def test_inner_control_points_lie_on_the_circle_or_on_the_floor(w1: float, w2: float, locus: str) -> None:
    p0, p3 = np.array([0.0, 0.1, 0.02]), np.array([0.25, 0.15, 0.2])
    points = control_points(p0, p3, (w1, w2), locus, 0.02)  # type: ignore[arg-type]
    radius = np.linalg.norm(p3 - p0) / 2
    for point in points[1:3]:
        on_circle = np.isclose(np.linalg.norm(point - (p0 + p3) / 2), radius)
        assert on_circle or point[2] == 0.02
        assert point[2] >= 0.02


def test_the_swing_side_locus_runs_from_p0_over_the_top_to_p3() -> None:
    p0, p3 = np.array([0.0, 0.0, 0.2]), np.array([0.2, 0.0, 0.2])
    first, top, last = (control_points(p0, p3, (w, w), "swing", 0.0)[1] for w in (0.0, 0.5, 1.0))
    np.testing.assert_allclose(first, p0, atol=1e-12)
    np.testing.assert_allclose(top, [0.1, 0.0, 0.3], atol=1e-12)
    np.testing.assert_allclose(last, p3, atol=1e-12)


def test_the_published_locus_starts_at_the_top_passes_p3_and_ends_below_the_chord() -> None:
    p0, p3 = np.array([0.0, 0.0, 0.2]), np.array([0.2, 0.0, 0.2])
    first, middle, last = (control_points(p0, p3, (w, w), "published", 0.0)[1] for w in (0.0, 0.5, 1.0))
    np.testing.assert_allclose(first, [0.1, 0.0, 0.3], atol=1e-12)
    np.testing.assert_allclose(middle, p3, atol=1e-12)
    np.testing.assert_allclose(last, [0.1, 0.0, 0.1], atol=1e-12)
