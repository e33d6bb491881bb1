"""What is drawn beside the bodies, against the physics that it is drawn of."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.history.run_history import RunHistory
from legpush.history.timeline import BOX, Timeline
from legpush.messages.planning import Plan
from legpush.messages.stepping import Outcome, Push
from legpush.scene.conventions import LEGS
from sim_proc.measures.support import support_margins
from sim_proc.scene_3d import overlays


def test_the_foot_of_a_push_goes_along_the_curve_that_is_drawn(timeline: Timeline) -> None:
    pushes = [step for step in timeline.steps if isinstance(step.motion, Push)]
    assert len(pushes) == 2
    for step in pushes:
        assert isinstance(step.motion, Push)
        curve = overlays.push_curve(timeline, step)
        assert curve is not None
        rows = slice(step.first_row + 20, step.first_row + 55)
        foot = timeline.tips_m[rows, LEGS.index(step.motion.leg)]
        away = np.linalg.norm(foot[:, None] - curve.points_m[None], axis=2).min(axis=1)
        assert away.max() < 0.03
        np.testing.assert_array_equal(curve.points_m[[0, -1]], curve.control_m[[0, -1]])


def test_a_reset_has_no_curve(timeline: Timeline) -> None:
    assert overlays.push_curve(timeline, timeline.steps[0]) is None


def test_the_support_polygon_holds_the_feet_that_stand_and_its_border_is_where_the_margin_says(
    timeline: Timeline,
) -> None:
    seen = set()
    for row in range(1, timeline.n_rows, 7):
        corners = overlays.support_polygon(timeline, row)
        n_loaded = int((timeline.contact_forces_n[row, :, 2] >= 1.0).sum())
        seen.add(len(corners))
        assert len(corners) == n_loaded
        if n_loaded < 3:
            continue
        ring = np.vstack([corners, corners[:1]])[:, :2]
        edge, away = np.diff(ring, axis=0), timeline.com_m[row, :2] - ring[:-1]
        inside = (edge[:, 0] * away[:, 1] - edge[:, 1] * away[:, 0]) / np.linalg.norm(edge, axis=1)
        loaded = timeline.contact_forces_n[row : row + 1, :, 2] >= 1.0
        com, feet = timeline.com_m[None, row : row + 1, :2], timeline.tips_m[row : row + 1, :, :2]
        margin = support_margins(com, feet, loaded)
        assert inside.min() == pytest.approx(margin[0, 0], abs=1e-9) or inside.min() < 0.0
    assert {3, 4} <= seen


def test_the_polygon_of_four_feet_one_of_which_lies_inside_has_three_corners() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.4, 0.2], [0.0, 1.0]])
    assert sorted(overlays.hull(points)) == [0, 1, 3]


def test_contact_forces_carry_the_robot(timeline: Timeline) -> None:
    arrows = overlays.contact_arrows(timeline, 5)
    newtons = (arrows[:, 1] - arrows[:, 0]) / overlays.FORCE_M_PER_N
    np.testing.assert_allclose(newtons, timeline.contact_forces_n[5])
    assert newtons[:, 2].sum() == pytest.approx(32.0 * 9.81, rel=0.1)
    assert not np.any(overlays.contact_arrows(timeline, 0)[:, 1] - overlays.contact_arrows(timeline, 0)[:, 0])


def test_foot_traces_end_at_the_feet_and_have_the_same_size_from_the_first_row_on(timeline: Timeline) -> None:
    for row in (0, 9, timeline.n_rows - 1):
        traces = overlays.foot_traces(timeline, row)
        assert traces.shape == (4, overlays.TRAIL_ROWS // overlays.TRAIL_STRIDE, 2, 3)
        np.testing.assert_array_equal(traces[:, -1, 1], timeline.tips_m[row])


def test_without_a_plan_no_path_and_no_tree_is_drawn(history: RunHistory, timeline: Timeline) -> None:
    assert overlays.plan_at(history, timeline, timeline.n_rows - 1, "box") is None
    assert overlays.followed_path(timeline, timeline.n_rows - 1).shape == (0, 3)


def test_without_ticks_the_box_has_a_trace_too_from_push_to_push(timeline: Timeline) -> None:
    ends = Timeline(timeline.scenario)
    for step in timeline.steps:
        ends.add(step.number, step.motion, Outcome(world=step.world, state_crc=1), step.time_ns)
    assert ends.n_rows == len(timeline.steps)
    for row in range(ends.n_rows):
        trace = overlays.box_trace(ends, row)
        np.testing.assert_allclose(trace[:, :2], ends.qpos[: row + 1, BOX][:, :2])


def test_the_trace_of_the_box_goes_on_to_the_box_and_has_no_more_points_the_longer_it_is(timeline: Timeline) -> None:
    last = timeline.n_rows - 1
    assert len(overlays.box_trace(timeline, last)) == pytest.approx(last / overlays.BOX_TRACE_TICKS, abs=2)
    long = Timeline(timeline.scenario)
    for number, tick in enumerate(range(0, 300_000, 100)):
        world = replace(timeline.steps[-1].world, tick=tick)
        long.add(number, timeline.steps[-1].motion, Outcome(world=world, state_crc=1), number)
    trace = overlays.box_trace(long, long.n_rows - 1)
    assert len(trace) <= overlays.MAX_BOX_POINTS + 1
    np.testing.assert_array_equal(trace[-1, :2], long.qpos[-1, BOX][:2])


def test_the_error_of_the_box_at_some_rows_is_that_of_all_at_these(timeline: Timeline) -> None:
    rows = np.array([0, 7, timeline.n_rows - 1])
    np.testing.assert_array_equal(timeline.box_error(rows), timeline.box_error()[rows])


def test_when_rows_were_computed_never_goes_back(timeline: Timeline) -> None:
    times = [timeline.time_ns_at(row) for row in range(timeline.n_rows)]
    assert all(np.diff(times) >= 0)
    assert times[-1] == timeline.steps[-1].time_ns


@pytest.mark.parametrize("n", [0, 1, 2, overlays.PATH_POINTS, 10 * overlays.PATH_POINTS])
def test_a_path_keeps_its_ends_however_many_waypoints_it_has(n: int) -> None:
    waypoints = tuple(Pose2(x_m=float(index), y_m=0.0, yaw_rad=0.0) for index in range(n))
    path = overlays.plan_path(Plan(status="exact", reason="", waypoints=waypoints))
    assert len(path) == min(n, overlays.PATH_POINTS)
    assert list(path[:1, 0]) + list(path[-1:, 0]) == ([0.0, n - 1.0] if n else [])
