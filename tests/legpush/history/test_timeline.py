"""An episode as rows of numbers: from traces, from states without one, and which row was when."""

from math import isnan, pi

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.history.timeline import LATER_COLUMNS, Timeline, is_whole
from legpush.messages.stepping import Outcome, Trace, Walk
from legpush.scene.conventions import BOX_QPOS, JOINT_QPOS, TRUNK_QPOS
from tests.legpush.examples import SCENARIO, TIPS, TRACE, WORLD

SECOND_NS = 10**9


def trace(*ticks: int) -> Trace:
    """Of these ticks, each number of a row that of its tick."""
    n = len(ticks)
    return Trace(
        tick=ticks,
        qpos=tuple((float(tick),) * 26 for tick in ticks),
        roll_pitch_rad=((0.0, 0.0),) * n,
        tips_m=(TIPS,) * n,
        contact_forces_n=(((0.0, 0.0, 1.0),) * 4,) * n,
        com_m=((0.0, 0.0, 0.5),) * n,
        zmp_m=((0.0, 0.0),) * n,
        support_margin_m=(0.1,) * n,
    )


def outcome(tick: int, traced: Trace | None = None) -> Outcome:
    return Outcome(world=replace(WORLD, tick=tick), state_crc=tick, trace=traced)


@pytest.fixture
def timeline() -> Timeline:
    """A step without time, one with a trace of three ticks, one without a trace, and one that takes no time again."""
    made = Timeline(SCENARIO)
    made.add(0, Walk(), outcome(0), 1 * SECOND_NS)
    made.add(1, Walk(), outcome(3, trace(1, 2, 3)), 4 * SECOND_NS)
    made.add(2, Walk(), outcome(7), 8 * SECOND_NS)
    made.add(3, Walk(), outcome(7), 9 * SECOND_NS)
    return made


def test_there_is_a_row_for_each_tick_of_a_trace_and_one_for_a_step_without(timeline: Timeline) -> None:
    assert timeline.tick.tolist() == [0, 1, 2, 3, 7]
    assert timeline.time_s.tolist() == pytest.approx([0.0, 0.02, 0.04, 0.06, 0.14])
    assert [(step.first_row, step.n_rows) for step in timeline.steps] == [(0, 1), (1, 3), (4, 1), (5, 0)]
    assert timeline.qpos[1:4, 5].tolist() == [1.0, 2.0, 3.0]


def test_a_trace_of_an_older_protocol_has_nan_for_what_it_lacks(timeline: Timeline) -> None:
    assert is_whole(trace(1, 2, 3))
    timeline.add(4, Walk(), outcome(9, replace(TRACE, tick=(8, 9))), 10 * SECOND_NS)
    for name in LATER_COLUMNS:
        rows = getattr(timeline, name)
        assert len(rows) == timeline.n_rows
        assert np.isnan(rows[1:4]).all()
        np.testing.assert_array_equal(rows[-2:], getattr(TRACE, name))


def test_a_row_without_a_trace_has_the_state_and_nan_for_the_rest(timeline: Timeline) -> None:
    row = timeline.qpos[4]
    assert row[TRUNK_QPOS].tolist() == [*WORLD.trunk.position_m, *WORLD.trunk.orientation_wxyz]
    assert row[JOINT_QPOS].tolist() == list(WORLD.joint_positions_rad)
    assert row[BOX_QPOS].tolist() == [*WORLD.box.position_m, *WORLD.box.orientation_wxyz]
    assert timeline.tips_m[4].tolist() == [list(tip) for tip in TIPS]
    for numbers in (timeline.com_m, timeline.zmp_m, timeline.contact_forces_n, timeline.support_margin_m):
        assert np.isnan(numbers[4]).all()
        assert not np.isnan(numbers[1:4]).any()
    assert not isnan(timeline.roll_pitch_rad[4, 0])


def test_many_rows_keep_their_values_while_the_arrays_grow() -> None:
    made = Timeline(SCENARIO)
    for step in range(50):
        made.add(step, Walk(), outcome(5 * step + 5, trace(*range(5 * step + 1, 5 * step + 6))), step)
    assert made.tick.tolist() == list(range(1, 251))
    assert made.qpos[:, 25].tolist() == list(range(1, 251))


def test_rows_cannot_be_written_to(timeline: Timeline) -> None:
    with pytest.raises(ValueError, match="read-only"):
        timeline.qpos[0, 0] = 1.0


def test_the_step_that_led_to_a_row_is_the_last_one_that_ends_there(timeline: Timeline) -> None:
    assert [timeline.step_at(row).number for row in range(5)] == [0, 1, 1, 1, 2]
    assert timeline.rows_at(np.array([-1.0, 0.0, 2.5, 6.0, 100.0])).tolist() == [0, 0, 2, 3, 4]


def test_rows_are_known_from_the_time_of_their_answer_on_and_are_spread_before_it(timeline: Timeline) -> None:
    assert [timeline.row_at(second * SECOND_NS) for second in (0, 1, 3, 4, 7, 8, 20)] == [0, 0, 0, 3, 3, 4, 4]
    assert [timeline.time_ns_at(row) / SECOND_NS for row in range(5)] == [1.0, 2.0, 3.0, 4.0, 8.0]


def test_the_error_of_the_box_is_its_distance_and_angle_to_the_goal() -> None:
    made = Timeline(SCENARIO)
    turned = replace(WORLD.box, position_m=(5.0, 5.0, 0.2), orientation_wxyz=(0.0, 0.0, 0.0, 1.0))
    made.add(0, Walk(), Outcome(world=replace(WORLD, box=turned), state_crc=0), 0)
    ((distance_m, angle_rad),) = made.box_error()
    assert distance_m == pytest.approx(3.0)
    assert angle_rad == pytest.approx(pi * 170 / 180)


def test_a_trace_is_whole_when_each_tick_has_all_its_numbers() -> None:
    assert is_whole(TRACE)
    assert not is_whole(replace(TRACE, com_m=TRACE.com_m[1:]))
    assert not is_whole(replace(TRACE, qpos=((0.0,) * 26, (0.0,) * 25)))
