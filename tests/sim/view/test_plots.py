"""The curves of the page, against the numbers that they show."""

import numpy as np
import pytest

from legpush.history.timeline import Timeline
from sim_proc.view.plots import MAX_POINTS, PLOTS, begun, chosen_rows, margins, rewards, torques


def test_the_rows_that_are_drawn_are_few_and_have_the_ends() -> None:
    for n in (1, 2, MAX_POINTS, 10 * MAX_POINTS + 3):
        rows = chosen_rows(n)
        assert len(rows) <= MAX_POINTS
        assert (rows[0], rows[-1]) == (0, n - 1)
        assert np.all(np.diff(rows) > 0)


def test_every_plot_has_as_many_curves_as_it_says_and_the_box_comes_nearer(timeline: Timeline) -> None:
    rows = chosen_rows(timeline.n_rows)
    drawn = {plot.title: plot.values(timeline, rows) for plot in PLOTS}
    assert {plot.title: len(plot.curves) for plot in PLOTS} == {title: len(curves) for title, curves in drawn.items()}
    position_cm = drawn["Box error"][0]
    assert position_cm[0] - position_cm[-1] == pytest.approx(11.0, abs=4.0)


def test_no_extreme_between_the_rows_that_are_drawn_is_lost(timeline: Timeline) -> None:
    rows = np.array([0, 3, 3, timeline.n_rows - 2])
    capture_cm, zmp_cm, support_cm = margins(timeline, rows)
    for drawn, values in (
        (support_cm, timeline.support_margin_m),
        (zmp_cm, timeline.zmp_margin_m),
        (capture_cm, timeline.capture_margin_m),
    ):
        assert drawn.tolist() == pytest.approx(
            [100 * np.nanmin(values[begin:end]) for begin, end in ((0, 3), (3, 4), (3, -2), (-2, None))]
        )
    hip_x, hip_y, knee = torques(timeline, np.array([0, timeline.n_rows - 1]))
    for drawn, kind in ((hip_x, 0), (hip_y, 1), (knee, 2)):
        assert drawn[0] == np.nanmax(np.abs(timeline.joint_torques_n_m[:-1, kind::3]))


def test_a_reward_is_drawn_over_the_ticks_of_its_step(timeline: Timeline) -> None:
    step = timeline.steps[-1]
    timeline.rewards[step.number] = 2.5
    try:
        drawn = rewards(timeline, np.arange(timeline.n_rows))
    finally:
        del timeline.rewards[step.number]
    np.testing.assert_array_equal(drawn == 2.5, np.arange(timeline.n_rows) >= step.first_row)


def test_a_curve_begins_with_its_first_number() -> None:
    nan = np.nan
    np.testing.assert_array_equal(begun(np.array([nan, nan, 3.0, nan, 4.0])), [3.0, nan, 3.0, nan, 4.0])
    np.testing.assert_array_equal(begun(np.array([nan, nan])), [nan, nan])
