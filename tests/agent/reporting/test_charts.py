"""The charts in the picture of a mission show the numbers of its record."""

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from agent_proc.reporting.charts import draw_box_error, draw_margin, draw_tilt
from agent_proc.reporting.picture_parts import MAX_POINTS
from legpush.arrays import Floats
from tests.agent.reporting.missions import push_alone, whole_mission


def new_axes() -> Axes:
    return Figure().add_subplot()


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


def test_the_support_margin_is_in_centimetres() -> None:
    record, _ = whole_mission()
    axes = new_axes()
    draw_margin(axes, record)

    assert heights(axes, 0).min() == pytest.approx(100.0 * record.ticks().support_margin_m.min())
    assert axes.get_ylabel() == "margin [cm]"


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
