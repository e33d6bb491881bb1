"""Ways with their detours cut off."""

from itertools import pairwise

from legpush.geometry import Pose2
from legpush.messages.planning import BoxPathQuery
from legpush.scene.scenario import Rectangle, Room
from planner_proc.box.pushes import Pushes, Way
from planner_proc.box.shortening import shortened
from planner_proc.clearance.field import ClearanceField
from tests.planner.boxes import OPEN, query
from tests.planner.maps import pose

CORNERS = (pose(2.0, 4.0), pose(3.5, 5.5, 0.5), pose(5.0, 4.5, -0.8), pose(6.0, 4.0))


def asked_in(room: Room) -> tuple[BoxPathQuery, Pushes]:
    asked = query(room, CORNERS[0], CORNERS[-1], present_side=0)
    return asked, Pushes(asked, ClearanceField(asked.grid))


def way_over(pushes: Pushes, *corners: Pose2) -> Way:
    return tuple(pushes.stage(0, a, b) for a, b in pairwise(corners))


def test_a_detour_in_the_open_becomes_nearly_the_straight_push() -> None:
    asked, pushes = asked_in(OPEN)
    detour = way_over(pushes, *CORNERS)
    assert pushes.cost_m(detour, 0) > 4.5

    way = shortened(detour, asked, pushes)

    assert (way[0].begin, way[-1].end) == (CORNERS[0], CORNERS[-1])
    assert all(a.end == b.begin for a, b in pairwise(way))
    assert 4.0 - 1e-9 <= pushes.cost_m(way, 0) < 4.05
    assert shortened(detour, asked, pushes) == way


def test_a_shortcut_is_free_where_an_obstacle_lies_on_the_straight_line() -> None:
    block = Rectangle(x_min_m=3.8, x_max_m=4.2, y_min_m=3.7, y_max_m=4.2)
    asked, pushes = asked_in(Room(size_m=(8.0, 8.0), obstacles=(block,)))
    detour = way_over(pushes, CORNERS[0], pose(3.0, 5.4, 0.8), pose(4.0, 6.0), pose(5.0, 5.4, -0.8), CORNERS[-1])
    assert pushes.free(detour, 0)

    way = shortened(detour, asked, pushes)

    assert 4.1 < pushes.cost_m(way, 0) < pushes.cost_m(detour, 0) - 0.1
    assert pushes.free(way, 0)


def test_a_straight_push_stays_as_it_is() -> None:
    asked, pushes = asked_in(OPEN)
    straight = way_over(pushes, CORNERS[0], CORNERS[-1])

    assert shortened(straight, asked, pushes) == straight
