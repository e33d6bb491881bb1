"""Who is there, and in which state, as liveliness tokens and messages tell it."""

import pytest

from legpush.bus.liveliness import KEEP_GONE, LEASE_S, Roster
from tests.legpush.fakes import Clock


@pytest.fixture
def clock() -> Clock:
    """Starts at 100 s."""
    return Clock()


@pytest.fixture
def roster(clock: Clock) -> Roster:
    """Nobody has been seen."""
    return Roster(clock)


def test_a_peer_that_never_came_is_not_there(roster: Roster) -> None:
    assert roster.describe("sim", "main") == "not there: it has not been seen yet"
    assert roster.live("sim", "main") == []


def test_a_live_peer_that_does_not_answer_is_slow(roster: Roster, clock: Clock) -> None:
    roster.token("sim", "main", "a", alive=True)
    assert roster.describe("sim", "main") == "slow: it is alive, no message from it yet"
    roster.heard("sim", "main", "a", "stepping")
    clock.now_s += 1.5
    assert roster.describe("sim", "main") == 'slow: it is alive, last heard 1.5 s ago, it says "stepping"'


def test_a_peer_whose_link_closed_while_it_was_talking_is_dead(roster: Roster, clock: Clock) -> None:
    roster.token("sim", "main", "a", alive=True)
    roster.heard("sim", "main", "a")
    clock.now_s += 0.5
    roster.token("sim", "main", "a", alive=False)
    clock.now_s += 3.0
    assert roster.describe("sim", "main") == "dead: its link closed 3.0 s ago, last heard 3.5 s ago"
    assert roster.live("sim") == []


def test_a_peer_that_was_silent_until_its_link_timed_out_is_frozen(roster: Roster, clock: Clock) -> None:
    roster.token("sim", "main", "a", alive=True)
    roster.heard("sim", "main", "a")
    clock.now_s += LEASE_S
    roster.token("sim", "main", "a", alive=False)
    assert roster.describe("sim", "main").startswith("frozen or cut off: its link timed out")


def test_several_live_peers_of_one_name_are_named(roster: Roster) -> None:
    for incarnation in ("b", "a"):
        roster.token("sim", "main", incarnation, alive=True)
    roster.token("sim", "other", "c", alive=True)
    assert roster.describe("sim", "main") == "several processes, 2 of them (a, b)"
    assert {sighting.incarnation for sighting in roster.live("sim")} == {"a", "b", "c"}


def test_each_time_a_token_comes_up_is_a_new_link(roster: Roster) -> None:
    for alive in (True, False, True):
        roster.token("sim", "main", "a", alive=alive)
    assert [(sighting.incarnation, sighting.n_links) for sighting in roster.live()] == [("a", 2)]


def test_peers_that_are_gone_are_forgotten_in_time_and_living_ones_never(roster: Roster) -> None:
    roster.token("sim", "main", "first", alive=True)
    for index in range(10 * KEEP_GONE):
        roster.token("agent", "main", str(index), alive=True)
        roster.token("agent", "main", str(index), alive=False)
    assert [sighting.incarnation for sighting in roster.live()] == ["first"]
    assert len(roster) <= KEEP_GONE + 2
