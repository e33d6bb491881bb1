"""Which settings of a search fit its steering."""

from itertools import product
from typing import get_args

import pytest
from msgspec.structs import replace

from legpush.scene.names import PlannerName, Steering
from legpush.scene.plan_settings import NOT_STEERED, PlanSettings, Smoothing, radius_fault, steering_fault


@pytest.mark.parametrize(("planner", "steering"), list(product(get_args(PlannerName), get_args(Steering))))
def test_every_combination_is_steered_or_refused_by_name(planner: PlannerName, steering: Steering) -> None:
    fault = steering_fault(PlanSettings(planner=planner, steering=steering, min_turning_radius_m=0.5))
    if steering in NOT_STEERED.get(planner, ()):
        assert f"a planner that can be steered by {steering} (rrt, " in fault
        assert fault.endswith(f", got {planner}")
    else:
        assert fault == ""


@pytest.mark.parametrize("steering", get_args(Steering))
def test_curves_need_a_radius_and_straight_lines_do_not(steering: Steering) -> None:
    settings = PlanSettings(planner="rrt", steering=steering)
    without = (
        "" if steering == "straight" else f"Expected min_turning_radius_m above 0 m for the steering {steering}, got 0"
    )
    assert radius_fault(settings) == steering_fault(settings) == without
    assert radius_fault(replace(settings, min_turning_radius_m=0.1)) == ""


def test_a_radius_between_straight_lines_needs_smoothing() -> None:
    settings = PlanSettings(min_turning_radius_m=0.5, smoothing=Smoothing(method="none"))
    assert "Expected the smoothing spline or band" in steering_fault(settings)
    assert steering_fault(replace(settings, min_turning_radius_m=0.0)) == ""
