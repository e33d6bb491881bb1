"""Buses that share a session see who else is there, and not one another."""

import pytest

from legpush.bus import keys
from legpush.bus.bundles.forwarding import SharedSession
from legpush.bus.endpoints import Endpoints
from tests.legpush.bus.memory_session import RUN, MemoryNetwork


def token(incarnation: str) -> str:
    """The token of a simulator."""
    return keys.liveliness(RUN, "sim", "main", incarnation)


@pytest.fixture
def network() -> MemoryNetwork:
    """Nobody is there yet."""
    return MemoryNetwork()


def test_tokens_of_others_are_seen_and_those_of_the_same_session_are_not(network: MemoryNetwork) -> None:
    session, other = (network.open_session(Endpoints(), "sim") for _ in range(2))
    own: set[str] = set()
    first, second = SharedSession(session, own), SharedSession(session, own)
    came: list[tuple[str, bool]] = []
    early = first.show_token(token("early"))
    second.watch_tokens(token("*"), lambda key, lives: came.append((key, lives)))
    kept = [first.show_token(token("late")), other.show_token(token("other"))]
    early()
    kept[1]()
    assert came == [(token("other"), True), (token("other"), False)]


def test_a_session_stays_open_for_the_others(network: MemoryNetwork) -> None:
    session = network.open_session(Endpoints(), "sim")
    SharedSession(session, set()).close()
    assert network.sessions == [session]
