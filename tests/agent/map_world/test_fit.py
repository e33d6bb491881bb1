"""The fit finds the surface that random pushes were drawn from."""

import numpy as np
import pytest

from agent_proc.map_world.fit import fit_surface
from legpush.errors import ConfigError
from tests.agent.map_world.fake_maps import drawn_series, known_surface


def test_without_residuals_every_number_comes_back() -> None:
    known = known_surface()

    found = fit_surface(drawn_series(known, 20, residuals=False))
    for name in ("depth_m", "forward_m", "left_m", "turn_rad", "curve", "first"):
        assert np.array(getattr(found, name)) == pytest.approx(np.array(getattr(known, name)), abs=2e-8), name
    assert found.quality.r_squared == pytest.approx((1.0, 1.0, 1.0))
    assert found.quality.cross_validated_rmse == pytest.approx((0.0, 0.0, 0.0), abs=1e-7)


def test_with_residuals_mean_and_covariance_are_estimated() -> None:
    known = known_surface()

    found = fit_surface(drawn_series(known, 200))
    for depth_m, scatter in ((0.01, 1e-3), (0.05, 2e-3), (0.11, 4e-3)):
        at = (np.ones(1), np.array([depth_m]), np.array([0.3]), np.array([0.8]))
        assert found.displacement(*at) == pytest.approx(known.displacement(*at), abs=scatter)
    assert sum(part.n for part in found.residuals) == found.quality.n == 4000
    for part, true in zip(found.residuals, known.residuals, strict=True):
        scale = np.sqrt(np.outer(true.covariance.diagonal(), true.covariance.diagonal()))
        assert np.abs((part.covariance - true.covariance) / scale).max() < 0.25
    assert all(0.8 < r_squared < 1.0 for r_squared in found.quality.r_squared)


def test_legs_that_are_no_mirror_images_are_told_by_their_difference() -> None:
    series = drawn_series(known_surface(), 30)
    shifted = [
        type(each)(
            face=each.face,
            before=each.before,
            pushes=tuple(
                type(push)(
                    **{name: getattr(push, name) for name in push.__struct_fields__ if name != "forward_m"},
                    forward_m=push.forward_m + (0.002 if push.leg == "FL" else 0.0),
                )
                for push in each.pushes
            ),
        )
        for each in series
    ]

    alike, unlike = (fit_surface(pushes).quality for pushes in (series, shifted))
    assert abs(alike.leg_difference[0]) < 4 * alike.leg_difference_error[0]
    assert unlike.leg_difference[0] == pytest.approx(0.002, abs=5e-4)
    assert unlike.leg_difference[0] > 4 * unlike.leg_difference_error[0]


@pytest.mark.parametrize("n_series", [1, 3])
def test_too_few_pushes_are_refused(n_series: int) -> None:
    with pytest.raises(ConfigError, match="Expected at least 10 pushes of every depth and two series at the rear"):
        fit_surface(drawn_series(known_surface(), n_series))
