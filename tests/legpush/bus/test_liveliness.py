"""Who is there, and in which state, as liveliness tokens and messages tell it."""

import pytest

from legpush.bus.liveliness import KEEP_GONE, LEASE_S, Liveliness
from legpush.messages.common import Role
from tests.legpush.fakes import Clock


@pytest.fixture
def clock() -> Clock:
    """Starts at 100 s."""
    return Clock()


@pytest.fixture
def liveliness(clock: Clock) -> Liveliness:
    """Nobody has been seen."""
    return Liveliness(clock)


def test_a_peer_that_never_came_is_not_there(liveliness: Liveliness) -> None:
    assert liveliness.describe("sim", "main") == "not there: it has not been seen yet"
    assert liveliness.live("sim", "main") == []


def test_a_live_peer_that_does_not_answer_is_slow(liveliness: Liveliness, clock: Clock) -> None:
    liveliness.note_token("sim", "main", "a", alive=True)
    assert liveliness.describe("sim", "main") == "slow: it is alive, no message from it yet"
    liveliness.note_message("sim", "main", "a", "stepping")
    clock.now_s += 1.5
    assert liveliness.describe("sim", "main") == 'slow: it is alive, last heard 1.5 s ago, it says "stepping"'


def test_a_peer_whose_link_closed_while_it_was_talking_is_dead(liveliness: Liveliness, clock: Clock) -> None:
    liveliness.note_token("sim", "main", "a", alive=True)
    liveliness.note_message("sim", "main", "a")
    clock.now_s += 0.5
    liveliness.note_token("sim", "main", "a", alive=False)
    clock.now_s += 3.0
    assert liveliness.describe("sim", "main") == "dead: its link closed 3.0 s ago, last heard 3.5 s ago"
    assert liveliness.live("sim") == []


def test_a_peer_that_was_silent_until_its_link_timed_out_is_frozen(liveliness: Liveliness, clock: Clock) -> None:
    liveliness.note_token("sim", "main", "a", alive=True)
    liveliness.note_message("sim", "main", "a")
    clock.now_s += LEASE_S
    liveliness.note_token("sim", "main", "a", alive=False)
    assert liveliness.describe("sim", "main").startswith("frozen or cut off: its link timed out")


def test_several_live_peers_of_one_name_are_named(liveliness: Liveliness) -> None:
    for incarnation in ("b", "a"):
        liveliness.note_token("sim", "main", incarnation, alive=True)
    liveliness.note_token("sim", "other", "c", alive=True)
    assert liveliness.describe("sim", "main") == "several processes, 2 of them (a, b)"
    assert {sighting.incarnation for sighting in liveliness.live("sim")} == {"a", "b", "c"}


def test_each_time_a_token_comes_up_is_a_new_link(liveliness: Liveliness) -> None:
    for alive in (True, False, True):
        liveliness.note_token("sim", "main", "a", alive=alive)
    assert [(sighting.incarnation, sighting.n_links) for sighting in liveliness.live()] == [("a", 2)]


def test_peers_that_are_gone_are_forgotten_in_time_and_living_ones_never(liveliness: Liveliness) -> None:
    liveliness.note_token("sim", "main", "first", alive=True)
    for index in range(10 * KEEP_GONE):
        liveliness.note_token("agent", "main", str(index), alive=True)
        liveliness.note_token("agent", "main", str(index), alive=False)
    assert [sighting.incarnation for sighting in liveliness.live()] == ["first"]
    assert len(liveliness) <= KEEP_GONE + 2


def test_a_token_of_another_role_or_name_says_nothing_about_an_incarnation(liveliness: Liveliness) -> None:
    liveliness.note_token("agent", "main", "a", alive=True)
    others: tuple[tuple[Role, str], ...] = (("launcher", "main"), ("agent", "other"))
    for role, name in others:
        liveliness.note_token(role, name, "a", alive=True)
        liveliness.note_token(role, name, "a", alive=False)
        assert not liveliness.is_live(role, name, "a")
    assert liveliness.is_live("agent", "main", "a")
    assert not liveliness.is_live("agent", "main", "b")
