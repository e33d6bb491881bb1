"""Ways of the robot around the box, and behind it."""

import numpy as np

from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import occupancy_grid
from legpush.scene.scenario import Rectangle, Room
from planner_proc.box.walking_space import AROUND_M, WalkingSpace, places_behind
from planner_proc.clearance.field import ClearanceField
from tests.planner.boxes import WALK_M
from tests.planner.maps import pose


def test_a_way_around_the_box_is_found_beyond_its_neighbourhood() -> None:
    walls = (Rectangle(x_min_m=0.0, x_max_m=6.8, y_min_m=1.8, y_max_m=2.0),)
    grid = occupancy_grid(Room(size_m=(8.0, 3.0), obstacles=walls))
    space = WalkingSpace(grid, ClearanceField(grid), WALK_M)
    box = Footprint(pose=pose(3.0, 0.9), length_m=0.4, width_m=0.5)
    behind, ahead, above = (pose(x_m, y_m).xy() for x_m, y_m in ((1.5, 0.9), (4.5, 0.9), (1.5, 2.5)))

    assert 6.8 - box.pose.x_m > AROUND_M
    assert not space.joins(behind[None], ahead, box)
    assert space.joins(ahead[None], above, box)
    assert space.joins(np.stack([behind, ahead]), above, box)


def test_no_way_leads_off_the_grid_or_to_where_the_trunk_has_no_room() -> None:
    grid = occupancy_grid(Room(size_m=(8.0, 3.0)))
    space = WalkingSpace(grid, ClearanceField(grid), WALK_M)
    box = Footprint(pose=pose(3.0, 1.5), length_m=0.4, width_m=0.5)
    here = pose(1.5, 1.5).xy()

    assert space.joins(here[None], pose(5.0, 1.5).xy(), box)
    assert not space.joins(here[None], pose(9.0, 1.5).xy(), box)
    assert not space.joins(here[None], pose(5.0, 2.8).xy(), box)
    assert not space.joins(here[None], box.pose.xy(), box)


def test_places_behind_a_stand_off_lie_straight_back_from_it() -> None:
    places = places_behind(pose(2.0, 1.0, np.pi / 2), (0.0, 0.3))

    np.testing.assert_allclose(places, [[2.0, 1.0, np.pi / 2], [2.0, 0.7, np.pi / 2]])
