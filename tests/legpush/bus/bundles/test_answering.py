"""A process of several simulators takes what is for them out of bundles, and counts the rest."""

import pytest

from legpush.bus import keys
from legpush.bus.bundles.answering import MOST_ASKED, AnsweringSession
from legpush.bus.endpoints import Endpoints
from legpush.messages import codec
from legpush.messages.bundle import Bundle, Part
from tests.legpush.bus.bundles.lab import answer, question
from tests.legpush.bus.memory_session import RUN, MemoryNetwork

PROCESS = "bundle0123456789ab"
ALL_ANSWERS = (keys.bundled_answers(RUN, PROCESS), *(keys.observation(RUN, name) for name in ("a", "b")))


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
    agent.put(keys.bundled_actions(RUN, PROCESS), bundle((a, question(1)), (keys.action(RUN, "c"), question(1))))
    agent.put(b, question(1))
    assert came == [(a, question(1)), (b, question(1))]
    assert shared.tally.as_dict() == {"unknown": 1}

    for name in ("a", "b", "a"):
        senders[name].send(answer(1))
    first, second = keys.observation(RUN, "a"), keys.observation(RUN, "b")
    together = keys.bundled_answers(RUN, PROCESS)
    assert answered == [(together, bundle((first, answer(1)))), (second, answer(1)), (first, answer(1))]


@pytest.mark.parametrize(
    "unanswered", [question(1), question(9, "gone"), b"no question"], ids=["own", "of another", "none"]
)
def test_a_question_that_gets_no_answer_changes_nothing_for_those_after_it(
    network: MemoryNetwork, unanswered: bytes
) -> None:
    shared = AnsweringSession(network.open_session(Endpoints(), "sim"), RUN, PROCESS)
    agent = network.open_session(Endpoints(), "agent")
    answered: list[str] = []
    for key in ALL_ANSWERS:
        agent.subscribe(key, lambda key, _: answered.append(key))
    for name in ("a", "b"):
        shared.member(name).subscribe(keys.action(RUN, name), lambda *_: None)
    sender = shared.member("a").publisher(keys.observation(RUN, "a"), "lockstep")
    agent.put(keys.bundled_actions(RUN, PROCESS), bundle((keys.action(RUN, "a"), unanswered)))
    agent.put(keys.action(RUN, "a"), question(2))
    sender.send(answer(2))
    assert answered == [keys.observation(RUN, "a")]
    assert not shared._collector._expected

    agent.put(keys.bundled_actions(RUN, PROCESS), bundle((keys.action(RUN, "a"), question(3))))
    sender.send(answer(3))
    assert answered == [keys.observation(RUN, "a"), keys.bundled_answers(RUN, PROCESS)]


def test_no_more_questions_are_kept_than_a_flood_may_fill(network: MemoryNetwork) -> None:
    shared = AnsweringSession(network.open_session(Endpoints(), "sim"), RUN, PROCESS)
    agent = network.open_session(Endpoints(), "agent")
    shared.member("a").subscribe(keys.action(RUN, "a"), lambda *_: None)
    for step in range(10 * MOST_ASKED):
        for _ in range(2):
            agent.put(keys.bundled_actions(RUN, PROCESS), bundle((keys.action(RUN, "a"), question(step))))
    assert [each.step for each in shared._asked["a"]] == list(range(9 * MOST_ASKED, 10 * MOST_ASKED))


def test_a_long_answer_goes_alone(network: MemoryNetwork) -> None:
    shared = AnsweringSession(network.open_session(Endpoints(), "sim"), RUN, PROCESS)
    agent = network.open_session(Endpoints(), "agent")
    answered: list[str] = []
    member = shared.member("a")
    member.subscribe(keys.action(RUN, "a"), lambda *_: None)
    agent.subscribe(keys.observation(RUN, "a"), lambda key, _: answered.append(key))
    agent.put(keys.bundled_actions(RUN, PROCESS), bundle((keys.action(RUN, "a"), question(1))))
    member.publisher(keys.observation(RUN, "a"), "lockstep").send(answer(1, n_bytes=100_000))
    assert answered == [keys.observation(RUN, "a")]
    assert not shared._collector._expected, "the others do not wait for it"


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
