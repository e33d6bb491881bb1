"""Reference curves: where they go, how they turn, and scenarios that have one."""

from math import atan, pi
from pathlib import Path

import numpy as np
import pytest

from legpush.errors import ScenarioError
from legpush.geometry import Pose2
from legpush.scenarios.file import copy_scenario, dump_scenario, load_scenario
from legpush.scene.reference import (
    STEP_M,
    Arcs,
    Left,
    Reference,
    Right,
    Sine,
    Straight,
    least_radius_m,
    reference_curve,
)

BEGIN = Pose2(x_m=1.0, y_m=2.0, yaw_rad=0.3)
SINE = Sine(amplitude_m=0.4, wavelength_m=4.0, n_periods=1.5)
EIGHT = Arcs(
    radius_m=0.9,
    segments=(
        Straight(length_m=0.9),
        Right(angle_deg=270.0),
        Straight(length_m=1.8),
        Left(angle_deg=270.0),
        Straight(length_m=0.9),
    ),
)


@pytest.mark.parametrize("reference", [SINE, EIGHT])
def test_a_curve_begins_along_the_box_and_its_direction_is_that_of_its_points(reference: Reference) -> None:
    curve = reference_curve(reference, BEGIN)

    assert curve[0].tolist() == pytest.approx([1.0, 2.0, 0.3])
    steps = np.diff(curve[:, :2], axis=0)
    lengths = np.hypot(*steps.T)
    assert lengths.max() <= STEP_M * (1 + 1e-9)
    middles = (curve[1:, 2] + curve[:-1, 2]) / 2
    off = np.arctan2(steps[:, 1], steps[:, 0]) - middles
    assert np.abs(np.arctan2(np.sin(off), np.cos(off))).max() < 1e-4
    curvature = np.abs(np.diff(curve[:, 2])) / lengths
    assert 1.0 / curvature.max() == pytest.approx(least_radius_m(reference), rel=1e-3)


def test_a_sine_swings_to_both_sides_of_its_axis() -> None:
    begin = Pose2(x_m=0.0, y_m=0.0, yaw_rad=atan(0.4 * 2 * pi / 4.0))
    curve = reference_curve(SINE, begin)

    assert (curve[:, 1].min(), curve[:, 1].max()) == pytest.approx((-0.4, 0.4), abs=1e-5)
    assert curve[-1].tolist() == pytest.approx([6.0, 0.0, -begin.yaw_rad], abs=1e-9)


def test_arcs_close_where_they_should() -> None:
    assert reference_curve(EIGHT, BEGIN)[-1].tolist() == pytest.approx([1.0, 2.0, 0.3], abs=1e-9)
    assert least_radius_m(Arcs(radius_m=0.9, segments=(Straight(length_m=1.0),))) == np.inf


@pytest.mark.parametrize("name", ["sine", "dubins_loop"])
def test_a_scenario_with_a_reference_is_written_and_read_again(name: str, tmp_path: Path) -> None:
    scenario = load_scenario(name)
    path = tmp_path / "again.toml"
    path.write_text(dump_scenario(scenario))

    assert scenario.reference is not None
    assert load_scenario(path) == scenario


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('kind = "sine"', 'kind = "spiral"', r"at `reference.kind`: expected one of sine, arcs, got 'spiral'"),
        (
            "amplitude_m = 0.4",
            "amplitude_m = -0.4",
            r"`reference.amplitude_m`: expected a number from 1e-06 to 1000",
        ),
        ("n_periods", "periods", r"at `reference.periods`: unknown field \(did you mean `n_periods`\?\)"),
        (
            "n_periods = 1.5",
            "n_periods = 1.0",
            r"at `goal.pose`: expected the end of the reference, x_m 6.000, y_m 2.5",
        ),
        ('kind = "sine"\n', "", r"at `reference.kind`: expected sine or arcs, got nothing"),
        (
            "wavelength_m = 4.0",
            "wavelength_m = 1e9",
            r"`reference.wavelength_m`: expected a number from 0.01 to 1000",
        ),
        (
            "[room]",
            "[pushing]\ncalibration_pushes = 4\n\n[room]",
            r"at `pushing.calibration_pushes`: expected at most 0, which fit on the straight beginning",
        ),
        ("[room]", '[pushing]\nfaces = ["left"]\n\n[room]', r"at `pushing.faces`: expected the rear face"),
        (
            "[10.0, 5.0]",
            "[10.0, 3.2]",
            r"at `reference`: expected at least 0.070 m from the box at \(2.63, 2.84\) on the reference to the border "
            r"of the room \(`pushing.margin_m`\), got 0.063 m",
        ),
    ],
)
def test_a_reference_that_cannot_be_is_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    copy_scenario("sine", path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))

    with pytest.raises(ScenarioError, match=message):
        load_scenario(path)


def test_a_segment_that_is_none_is_refused_with_the_choices(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    copy_scenario("dubins_loop", path)
    path.write_text(path.read_text().replace('turn = "right"', 'turn = "up"'))

    with pytest.raises(
        ScenarioError, match=r"reference.segments\[1\].turn`: expected one of straight, left, right, got 'up'"
    ):
        load_scenario(path)


@pytest.mark.parametrize("value", ['"sine"', "5", '["sine"]'])
def test_a_reference_that_is_no_table_is_refused_with_the_choices(value: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    copy_scenario("push", path)
    path.write_text(f"reference = {value}\n{path.read_text()}")

    with pytest.raises(ScenarioError, match=r"at `reference`: expected a table with kind = sine or arcs"):
        load_scenario(path)
