"""The reference of a scenario as a stage."""

from math import asin, pi, sin

import numpy as np
import pytest

from agent_proc.pushing.reference_stage import reference_path, trailing
from legpush.geometry import Pose2, wrap_angle
from legpush.scene.reference import Arcs, Left, Straight, reference_curve
from tests.agent.pushing.paths import AXLE_M, EIGHT, START


@pytest.mark.parametrize("axle_m", [0.0, 0.15, 0.3])
def test_headings_along_a_curve_are_those_of_a_box_that_does_not_slip(axle_m: float) -> None:
    curve = reference_curve(EIGHT, START)
    headings = trailing(curve, axle_m)

    axles = curve[:, :2] - axle_m * np.stack([np.cos(headings), np.sin(headings)], axis=1)
    steps = np.diff(axles, axis=0)
    middle = (headings[1:] + headings[:-1]) / 2
    sideways = np.cos(middle) * steps[:, 1] - np.sin(middle) * steps[:, 0]
    assert np.abs(sideways).max() < 1e-5


def test_a_straight_reference_is_a_straight_stage_at_the_rear_face() -> None:
    begin = Pose2(x_m=1.0, y_m=2.0, yaw_rad=0.5)

    stage = reference_path(Arcs(radius_m=1.0, segments=(Straight(length_m=1.5),)), begin, AXLE_M)

    end = begin @ Pose2(x_m=1.5, y_m=0.0, yaw_rad=0.0)
    assert stage.face == "rear"
    assert stage.length_m == pytest.approx(1.5)
    assert stage.straight_until_m(0.0) == stage.length_m
    turned = stage.pose(0.5) @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.3)
    assert stage.deviation(turned, 0.0, 1.0).left_m == pytest.approx(-AXLE_M * sin(0.3))
    assert (stage.end.x_m, stage.end.y_m, stage.end.yaw_rad) == pytest.approx((end.x_m, end.y_m, end.yaw_rad))


def test_the_centre_of_the_box_lies_on_the_curve_all_along_the_stage() -> None:
    curve = reference_curve(EIGHT, START)

    stage = reference_path(EIGHT, START, AXLE_M)

    places = np.array([stage.pose(at_m).xy() for at_m in np.linspace(0.0, stage.length_m, 50)])
    nearest_m = np.hypot(*(places[:, None] - curve[None, :, :2]).transpose(2, 0, 1)).min(axis=1)
    assert nearest_m.max() < 0.006


def test_a_stage_ends_with_the_direction_of_the_curve_though_the_heading_lags_behind_it() -> None:
    stage = reference_path(Arcs(radius_m=1.0, segments=(Left(angle_deg=270.0),)), START, AXLE_M)

    assert stage.end.yaw_rad == pytest.approx(-pi / 2)
    lag_rad = wrap_angle(stage.end.yaw_rad - stage.pose(stage.length_m).yaw_rad)
    assert lag_rad == pytest.approx(asin(AXLE_M / 1.0), abs=0.002)
