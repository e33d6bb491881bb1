"""A process of several simulators takes what is for them out of bundles, and counts the rest."""

import pytest

from legpush.bus import keys
from legpush.bus.bundles.answering import AnsweringSession
from legpush.bus.endpoints import Endpoints
from legpush.messages import codec
from legpush.messages.bundle import Bundle, Part
from tests.legpush.bus.memory_session import RUN, MemoryNetwork

PROCESS = "bundle0123456789ab"
LONG = b"x" * 100_000


@pytest.fixture
def network() -> MemoryNetwork:
    """Nobody is there yet."""
    return MemoryNetwork()


def bundle(*parts: tuple[str, bytes]) -> bytes:
    """Messages in one."""
    return codec.encode(Bundle(parts=tuple(Part(key=key, payload=payload) for key, payload in parts)))


def test_each_simulator_gets_its_own_and_answers_as_it_was_asked(network: MemoryNetwork) -> None:
    shared = AnsweringSession(network.open_session(Endpoints(), "sim"), RUN, PROCESS)
    agent = network.open_session(Endpoints(), "agent")
    came: list[tuple[str, bytes]] = []
    answered: list[tuple[str, bytes]] = []
    senders = {}
    for name in ("a", "b"):
        member = shared.member(name)
        member.subscribe(keys.action(RUN, name), lambda key, payload: came.append((key, payload)))
        senders[name] = member.publisher(keys.observation(RUN, name), "lockstep")
        agent.subscribe(keys.observation(RUN, name), lambda key, payload: answered.append((key, payload)))
    agent.subscribe(keys.bundled_answers(RUN, PROCESS), lambda key, payload: answered.append((key, payload)))

    a, b = keys.action(RUN, "a"), keys.action(RUN, "b")
    agent.put(keys.bundled_actions(RUN, PROCESS), bundle((a, b"1"), (keys.action(RUN, "c"), b"2")))
    agent.put(b, b"3")
    assert came == [(a, b"1"), (b, b"3")]
    assert shared.tally.as_dict() == {"unknown": 1}

    for name, payload in (("a", b"4"), ("b", b"5"), ("a", b"6")):
        senders[name].send(payload)
    first, second = keys.observation(RUN, "a"), keys.observation(RUN, "b")
    together = keys.bundled_answers(RUN, PROCESS)
    assert answered == [(together, bundle((first, b"4"))), (second, b"5"), (first, b"6")]


def test_a_long_answer_goes_alone(network: MemoryNetwork) -> None:
    shared = AnsweringSession(network.open_session(Endpoints(), "sim"), RUN, PROCESS)
    agent = network.open_session(Endpoints(), "agent")
    answered: list[str] = []
    member = shared.member("a")
    member.subscribe(keys.action(RUN, "a"), lambda *_: None)
    agent.subscribe(keys.observation(RUN, "a"), lambda key, _: answered.append(key))
    agent.put(keys.bundled_actions(RUN, PROCESS), bundle((keys.action(RUN, "a"), b"1")))
    member.publisher(keys.observation(RUN, "a"), "lockstep").send(LONG)
    assert answered == [keys.observation(RUN, "a")]


def test_a_simulator_that_leaves_gets_nothing_any_more_and_the_others_stay(network: MemoryNetwork) -> None:
    shared = AnsweringSession(network.open_session(Endpoints(), "sim"), RUN, PROCESS)
    agent = network.open_session(Endpoints(), "agent")
    came: list[str] = []
    members = {name: shared.member(name) for name in ("a", "b")}

    def take(key: str, _: bytes) -> None:
        came.append(key)

    leave = {name: each.subscribe(keys.action(RUN, name), take) for name, each in members.items()}
    leave["a"]()
    members["a"].close()
    both = [(keys.action(RUN, name), b"") for name in ("a", "b")]
    agent.put(keys.bundled_actions(RUN, PROCESS), bundle(*both))
    agent.put(keys.action(RUN, "a"), b"")
    assert came == [keys.action(RUN, "b")]
    shared.close()
    agent.put(keys.bundled_actions(RUN, PROCESS), bundle(*both))
    assert came == [keys.action(RUN, "b")]
