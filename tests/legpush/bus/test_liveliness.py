"""Who is there, and in which state, as liveliness tokens and messages tell it."""

import pytest
from msgspec.structs import replace

from legpush.bus.liveliness import KEEP_GONE, LEASE_S, MOST_OTHERS, Liveliness
from legpush.messages.common import PROTOCOL_VERSION, Role
from legpush.messages.telemetry import Status
from tests.legpush.examples import MESSAGES
from tests.legpush.fakes import Clock


@pytest.fixture
def clock() -> Clock:
    """Starts at 100 s."""
    return Clock()


@pytest.fixture
def liveliness(clock: Clock) -> Liveliness:
    """Nobody has been seen."""
    return Liveliness(clock)


def status_of(incarnation: str, phase: str, numerics: str = "") -> Status:
    """What the simulator `main` says of itself."""
    status = MESSAGES["status"]
    assert isinstance(status, Status)
    header = replace(status.header, role="sim", name="main", incarnation=incarnation)
    return replace(status, header=header, phase=phase, numerics=numerics)


def test_a_peer_that_never_came_is_not_there(liveliness: Liveliness) -> None:
    assert liveliness.describe("sim", "main") == "not there: it has not been seen yet"
    assert liveliness.live("sim", "main") == []


def test_a_live_peer_that_does_not_answer_is_slow(liveliness: Liveliness, clock: Clock) -> None:
    liveliness.note_token("sim", "main", "a", alive=True)
    assert liveliness.describe("sim", "main") == "slow: it is alive, no message from it yet"
    liveliness.note_message("sim", "main", "a")
    liveliness.note_status(status_of("a", "stepping"))
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
    assert sum(map(len, liveliness._of_peer.values())) == len(liveliness)
    for index in range(10 * KEEP_GONE):
        liveliness.note_token("agent", str(index), "a", alive=True)
        liveliness.note_token("agent", str(index), "a", alive=False)
    assert len(liveliness._of_peer) <= KEEP_GONE + 2
    assert [sighting.incarnation for sighting in liveliness.live("sim", "main")] == ["first"]


def test_a_token_of_another_role_or_name_says_nothing_about_an_incarnation(liveliness: Liveliness) -> None:
    liveliness.note_token("agent", "main", "a", alive=True)
    others: tuple[tuple[Role, str], ...] = (("launcher", "main"), ("agent", "other"))
    for role, name in others:
        liveliness.note_token(role, name, "a", alive=True)
        liveliness.note_token(role, name, "a", alive=False)
        assert not liveliness.is_live(role, name, "a")
    assert liveliness.is_live("agent", "main", "a")
    assert not liveliness.is_live("agent", "main", "b")


def test_a_peer_of_another_version_is_named_but_not_there(liveliness: Liveliness) -> None:
    liveliness.note_other_version("sim", "main", "a", PROTOCOL_VERSION + 1, alive=True)
    assert liveliness.live() == []
    assert liveliness.other_versions("sim") == {"main": PROTOCOL_VERSION + 1}
    words = f"of another version: it speaks protocol {PROTOCOL_VERSION + 1}, expected {PROTOCOL_VERSION}"
    assert liveliness.describe("sim", "main") == liveliness.describe("sim") == words
    assert liveliness.describe("sim", "other") == "not there: it has not been seen yet"

    liveliness.note_other_version("sim", "main", "a", PROTOCOL_VERSION + 1, alive=False)
    assert liveliness.describe("sim", "main") == "not there: it has not been seen yet"


def test_a_peer_that_comes_back_with_another_version_is_named_and_not_called_dead(liveliness: Liveliness) -> None:
    for alive in (True, False):
        liveliness.note_token("sim", "main", "a", alive=alive)
    liveliness.note_other_version("sim", "main", "b", PROTOCOL_VERSION + 1, alive=True)
    assert liveliness.describe("sim", "main").startswith("of another version")

    liveliness.note_token("sim", "main", "c", alive=True)
    assert liveliness.describe("sim", "main").startswith("slow: it is alive")


def test_what_a_simulator_computes_with_is_known_from_its_status(liveliness: Liveliness) -> None:
    liveliness.note_token("sim", "main", "a", alive=True)
    assert [peer.numerics for peer in liveliness.live("sim")] == [None]
    liveliness.note_status(status_of("a", "idle", "x86-64-v3/1a2b3c4d, motions 4"))
    assert [peer.numerics for peer in liveliness.live("sim")] == ["x86-64-v3/1a2b3c4d, motions 4"]


def test_a_flood_of_peers_of_another_version_does_not_fill_the_memory(liveliness: Liveliness) -> None:
    for index in range(2 * MOST_OTHERS):
        liveliness.note_other_version("sim", f"s{index}", "a", PROTOCOL_VERSION + 1, alive=True)
    assert len(liveliness.other_versions("sim")) == MOST_OTHERS
