"""Walks of the body around the box."""

import numpy as np

from legpush.scene.footprints import Footprint
from planner_proc.box.body_walks import BodyWalks
from tests.planner.bodies import BODY, BODY_M
from tests.planner.maps import pose, room

BOX = Footprint(pose=pose(4.0, 3.0), length_m=0.4, width_m=0.5)
BEHIND = np.array([[2.9, 3.0, 0.0], [2.6, 3.0, 0.0]])
BESIDE = np.array([4.0, 1.8, np.pi / 2])
DISC_M = 0.442


def test_the_body_walks_around_a_box_in_the_open() -> None:
    assert BodyWalks(room(), BOX, BODY, DISC_M, BODY_M).joins(BEHIND, BESIDE)


def test_it_does_not_where_only_a_disc_has_room_to_turn() -> None:
    corridor = room((0.0, 8.0, 0.0, 1.2), (0.0, 8.0, 2.3, 6.0))
    box = Footprint(pose=pose(6.0, 2.0), length_m=0.1, width_m=0.1)
    begins, end = np.array([[3.0, 1.75, 0.0]]), np.array([4.0, 1.75, np.pi])

    assert not BodyWalks(corridor, box, BODY, DISC_M, BODY_M).joins(begins, end)
    assert BodyWalks(corridor, box, BODY, DISC_M, BODY_M).joins(begins, np.array([4.0, 1.75, 0.0]))


def test_it_does_not_begin_where_it_does_not_fit() -> None:
    assert not BodyWalks(room((2.0, 2.5, 2.8, 3.2)), BOX, BODY, DISC_M, BODY_M).joins(BEHIND, BESIDE)
