"""The charts in the picture of a mission show the numbers of its record."""

import dataclasses

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from agent_proc.reporting.mission_picture.charts import draw_box_error, draw_margins, draw_tilt, draw_torques
from agent_proc.reporting.mission_picture.parts import MAX_POINTS
from agent_proc.reporting.mission_record import MissionRecord
from legpush.arrays import Floats
from tests.agent.reporting.missions import push_alone, whole_mission


def new_axes() -> Axes:
    return Figure().add_subplot()


def measured_mission() -> MissionRecord:
    """A mission whose last motion has all that traces have since protocol 8."""
    record, _ = whole_mission()
    last = record.steps[-1]
    n = len(last.ticks.time_s)
    draw = np.random.default_rng(0).uniform
    ticks = dataclasses.replace(
        last.ticks,
        zmp_margin_m=draw(0.0, 0.1, n),
        capture_margin_m=draw(-0.1, 0.1, n),
        torques_n_m=draw(0.0, 90.0, (n, 3)),
    )
    return dataclasses.replace(record, steps=[*record.steps[:-1], dataclasses.replace(last, ticks=ticks)])


def labels(axes: Axes) -> list[str]:
    return [str(label) for label in axes.get_legend_handles_labels()[1]]


def heights(axes: Axes, index: int) -> Floats:
    """All values of the band with this index."""
    paths = axes.collections[index].get_paths()
    return np.concatenate([np.asarray(path.vertices, dtype=np.float64)[:, 1] for path in paths])


def values_of(line: Line2D) -> Floats:
    return np.asarray(line.get_ydata(), dtype=np.float64)


def test_pitch_and_roll_keep_their_extremes() -> None:
    record, _ = whole_mission()
    ticks = record.ticks()
    assert len(ticks.time_s) > MAX_POINTS // 4
    axes = new_axes()
    draw_tilt(axes, record)

    assert labels(axes) == ["pitch", "roll"]
    for index, values in enumerate(np.degrees(ticks.roll_pitch_rad[:, ::-1]).T):
        assert heights(axes, index).min() == pytest.approx(values.min())
        assert heights(axes, index).max() == pytest.approx(values.max())


def test_margins_and_torques_keep_their_extremes() -> None:
    record = measured_mission()
    ticks = record.ticks()
    margins, torques = new_axes(), new_axes()
    draw_margins(margins, record)
    draw_torques(torques, record)

    assert labels(margins) == ["ZMP", "CoM", "capture point"]
    for line, values in zip(
        margins.lines, (ticks.zmp_margin_m, ticks.support_margin_m, ticks.capture_margin_m), strict=False
    ):
        assert np.nanmin(values_of(line)) == pytest.approx(100.0 * np.nanmin(values))
    assert margins.get_ylabel() == "margin [cm]"
    assert labels(torques) == ["hip-x", "hip-y", "knee"]
    for line, values in zip(torques.lines, ticks.torques_n_m.T, strict=True):
        assert np.nanmax(values_of(line)) == np.nanmax(values) > 0.0


def test_a_mission_of_an_older_protocol_has_the_margin_of_the_com_alone() -> None:
    record, _ = whole_mission()
    margins, torques = new_axes(), new_axes()
    draw_margins(margins, record)
    draw_torques(torques, record)

    assert labels(margins) == ["CoM"]
    assert labels(torques) == []


def test_walking_and_pushing_are_told_apart_and_named() -> None:
    both, pushing = new_axes(), new_axes()
    draw_tilt(both, whole_mission()[0])
    draw_tilt(pushing, push_alone()[0])

    assert [text.get_text().strip() for text in both.texts] == ["walk", "push"]
    assert [text.get_text().strip() for text in pushing.texts] == ["push"]


def test_errors_of_the_box_are_in_tolerances_of_the_goal() -> None:
    record, _ = push_alone()
    goal, steps = record.scenario.goal, record.pushing()
    axes = new_axes()
    draw_box_error(axes, record)
    position, angle = axes.lines

    assert labels(axes) == ["position (in 3 cm)", "angle (in 3°)"]
    errors = [record.box_error(step) for step in steps]
    np.testing.assert_allclose(values_of(position), [e.position_m / goal.position_tolerance_m for e in errors])
    np.testing.assert_allclose(values_of(angle), [np.degrees(e.angle_rad) / goal.angle_tolerance_deg for e in errors])
    assert values_of(position)[-1] < 1.0
