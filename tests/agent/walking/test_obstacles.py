"""What is known of obstacles that appear, and whether they stand in a way."""

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.walking.obstacles import in_words, is_in_walk, known_scenario
from legpush.errors import PeerError
from legpush.geometry import Pose2
from legpush.messages.stepping import Appearance
from legpush.scene.occupancy import clearance_m
from legpush.scene.scenario import Rectangle, Room
from tests.agent.fake_world import make_scenario, make_state
from tests.robots import CIRCLE_M

WALL = Rectangle(x_min_m=0.0, x_max_m=0.2, y_min_m=0.0, y_max_m=6.0)
CRATE = Rectangle(x_min_m=4.0, x_max_m=4.5, y_min_m=1.0, y_max_m=2.0, appears_at_s=3.0)
GATE = replace(CRATE, y_min_m=4.0, y_max_m=5.0)
SCENARIO = make_scenario(room=Room(size_m=(12.0, 6.0), obstacles=(WALL, CRATE, GATE)))
CLEARANCE_M = clearance_m(SCENARIO)
HERE = Pose2(x_m=1.5, y_m=3.0, yaw_rad=0.0)


def test_only_what_stands_there_is_known() -> None:
    none, gate = (
        known_scenario(SCENARIO, make_state(HERE, HERE, appeared=appeared))
        for appeared in ((), (Appearance(obstacle=2, tick=150),))
    )

    assert none.room.obstacles == (WALL,)
    assert gate.room.obstacles == (WALL, GATE)
    assert replace(gate, room=SCENARIO.room) == SCENARIO


def test_a_scenario_in_which_nothing_appears_is_known_as_it_is() -> None:
    plain = make_scenario(room=Room(size_m=(12.0, 6.0), obstacles=(WALL,)))

    assert known_scenario(plain, make_state(HERE, HERE)) is plain


@pytest.mark.parametrize("obstacle", [0, 3])
def test_an_obstacle_that_cannot_appear_is_the_fault_of_a_peer(obstacle: int) -> None:
    state = make_state(HERE, HERE, tick=200, appeared=(Appearance(obstacle=obstacle, tick=150),))

    with pytest.raises(PeerError, match=rf"at tick 200 an obstacle that appears later \(1, 2\), got {obstacle}"):
        known_scenario(SCENARIO, state)


def test_people_are_told_which_obstacle_appeared_when() -> None:
    appeared = (Appearance(obstacle=2, tick=150), Appearance(obstacle=1, tick=275))

    assert in_words(appeared) == "room.obstacles[2] at 3.0 s, room.obstacles[1] at 5.5 s"


@pytest.mark.parametrize(("beside_m", "expected"), [(-0.01, True), (0.01, False)])
@pytest.mark.parametrize("n_waypoints", [2, 80])
def test_a_walk_is_blocked_by_what_is_nearer_than_the_clearance(
    beside_m: float, expected: bool, n_waypoints: int
) -> None:
    y_m = CRATE.y_max_m + CLEARANCE_M + beside_m
    way = [Pose2(x_m=float(x_m), y_m=y_m, yaw_rad=0.0) for x_m in np.linspace(1.0, 8.0, n_waypoints)]

    assert is_in_walk(CRATE, SCENARIO, way) == expected


def test_only_what_is_left_of_a_walk_counts_with_turns_as_long_as_their_arc() -> None:
    way = [
        Pose2(x_m=4.2, y_m=0.6, yaw_rad=0.0),
        Pose2(x_m=4.2, y_m=0.6, yaw_rad=3.0),
        Pose2(x_m=2.2, y_m=0.6, yaw_rad=3.0),
    ]
    turn_m = 3.0 * CIRCLE_M

    assert is_in_walk(CRATE, SCENARIO, way, turn_m)
    assert is_in_walk(CRATE, SCENARIO, way, turn_m + 0.1)
    assert not is_in_walk(CRATE, SCENARIO, way, turn_m + 0.45)


def test_a_walk_is_blocked_where_the_body_would_turn_into_an_obstacle() -> None:
    y_m = CRATE.y_max_m + CLEARANCE_M + 0.01
    along = [Pose2(x_m=x_m, y_m=y_m, yaw_rad=0.0) for x_m in (3.0, 4.25)]

    assert not is_in_walk(CRATE, SCENARIO, along)
    assert is_in_walk(CRATE, SCENARIO, [*along, Pose2(x_m=4.25, y_m=y_m, yaw_rad=1.5)])
