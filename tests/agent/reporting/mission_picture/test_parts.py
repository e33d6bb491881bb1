"""The geometry of the picture of a mission."""

import numpy as np
import pytest

from agent_proc.reporting.mission_picture.parts import (
    AROUND_M,
    MAX_POINTS,
    PLAN_ASPECT,
    appeared,
    box_at,
    box_paths,
    extent,
    followed,
    handover_place,
    planned_again,
    pushed_faces,
    thin,
    widen,
)
from legpush.geometry import distance_m
from legpush.messages.poses import planar_pose
from tests.agent.reporting.missions import blocked_mission, unplanned_mission, whole_mission


def test_a_path_is_given_up_that_an_obstacle_appeared_in_and_no_other() -> None:
    record, _ = blocked_mission()

    assert [given_up for _, given_up in followed(record)] == [True, False, False]
    assert [each.obstacle for each in appeared(record)] == [1, 2]
    assert not any(given_up for _, given_up in followed(whole_mission()[0]))


def test_the_hand_over_is_where_a_path_began_at_its_distance_from_the_box() -> None:
    record, result = whole_mission()
    assert result.handover_distance_m is not None
    place = handover_place(record, result.handover_distance_m)

    box = planar_pose(record.steps[0].world.box)
    assert distance_m(place, box) == pytest.approx(result.handover_distance_m, abs=1e-6)
    assert place in [planar_pose(step.world.trunk) for step, _ in followed(record)]


def test_the_box_is_drawn_where_it_was() -> None:
    record, _ = whole_mission()
    for step in (record.steps[0], record.steps[-1]):
        np.testing.assert_allclose(box_at(record, step).corners().mean(axis=0), step.world.box.position_m[:2])


def test_the_picture_shows_all_that_happened_and_nothing_beyond_the_room() -> None:
    record, _ = whole_mission()
    low, high = extent(record)
    trunks = np.array([step.world.trunk.position_m[:2] for step in record.steps])

    assert (low >= 0.0).all()
    assert (high <= record.scenario.room.size_m).all()
    assert (trunks >= np.minimum(low + AROUND_M, trunks.min(axis=0))).all()
    assert low[0] == 0.0 or high[0] - low[0] == pytest.approx(PLAN_ASPECT * (high[1] - low[1]))
    for corners in (box_at(record, record.steps[0]).corners(), box_at(record, record.steps[-1]).corners()):
        assert ((corners >= low) & (corners <= high)).all()


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        ((0.0, 0.0), (4.0, 1.0), ((0.0, -0.5), (4.0, 1.5))),
        ((0.0, 0.0), (1.0, 3.0), ((-2.5, 0.0), (3.5, 3.0))),
        ((1.0, 2.0), (3.0, 3.0), ((1.0, 2.0), (3.0, 3.0))),
    ],
)
def test_a_frame_is_widened_around_its_centre(
    low: tuple[float, float], high: tuple[float, float], expected: tuple[tuple[float, float], tuple[float, float]]
) -> None:
    widened = widen(np.array(low), np.array(high), 2.0)

    np.testing.assert_allclose(widened, expected)


@pytest.mark.parametrize("n_points", [1, 2, MAX_POINTS, MAX_POINTS + 1, 3 * MAX_POINTS + 7])
def test_a_thinned_line_keeps_its_ends(n_points: int) -> None:
    points = np.arange(2.0 * n_points).reshape(n_points, 2)
    thinned = thin(points)

    assert len(thinned) <= MAX_POINTS + 1
    np.testing.assert_array_equal(thinned[[0, -1]], points[[0, -1]])
    assert len(thinned) > min(n_points, MAX_POINTS) // 2


def test_a_path_of_the_box_is_one_along_which_it_was_pushed() -> None:
    record, _ = whole_mission()
    ((path_m, begin),) = box_paths(record)

    assert path_m is record.pushing()[-1].box_path_m
    assert begin == planar_pose(record.pushing()[0].world.box)
    assert pushed_faces(record) == ["rear"]
    assert len(planned_again(record)) == 0


def test_the_mission_plans_again_where_its_path_was_blocked() -> None:
    record, _ = blocked_mission()
    walks = followed(record)
    assert [pose.tolist() for pose in planned_again(record)] == [list(walks[1][0].world.trunk.position_m[:2])]


def test_a_mission_that_does_not_move_has_no_paths_and_no_panels() -> None:
    record, _ = unplanned_mission()
    assert box_paths(record) == []
    assert pushed_faces(record) == []
    assert planned_again(record).shape == (0, 2)
