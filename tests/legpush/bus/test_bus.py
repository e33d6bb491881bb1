"""The bus on a network in memory: headers, who is there, and everything that must not come through."""

from collections.abc import Callable
from typing import Any

import msgpack
import pytest

from legpush.bus import channels, keys, ports
from legpush.bus.endpoints import Endpoints
from legpush.bus.faults import Faults
from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Header
from legpush.messages.stepping import Action, Walk
from legpush.messages.telemetry import Fact, Status
from tests.legpush.bus.memory_session import RUN, KeptBatches, MemoryNetwork, MemorySession
from tests.legpush.examples import MESSAGES
from tests.legpush.fakes import eventually

FACT = Fact(name="model.xml", media_type="application/xml", data=b"<mujoco/>")
ANY_STATUS: dict[str, Any] = msgpack.unpackb(codec.encode(MESSAGES["status"]))


def say(phase: str) -> Callable[[Header], Status]:
    """A status to send."""
    return lambda header: Status(header=header, phase=phase)


def status_with(**header: object) -> bytes:
    """A status whose header differs in these fields."""
    packed: bytes = msgpack.packb({**ANY_STATUS, "header": {**ANY_STATUS["header"], **header}})
    return packed


@pytest.fixture
def network() -> MemoryNetwork:
    """Nobody is on it yet."""
    return MemoryNetwork()


@pytest.fixture
def stranger(network: MemoryNetwork) -> MemorySession:
    """A session as anybody could open it."""
    return network.open_session(Endpoints(), "a stranger")


def test_every_header_says_who_and_counts_the_messages_of_its_key(network: MemoryNetwork) -> None:
    with network.bus("sim") as sim, network.bus("agent") as agent:
        heard = agent.subscribe(channels.statuses(RUN))
        publisher = sim.publisher(channels.statuses(RUN, "sim", "main"))
        for _ in range(3):
            publisher.send(say("stepping"))
        headers = [message.header for message in heard.drain()]
    assert headers[0] == Header(
        protocol=PROTOCOL_VERSION, run=RUN, role="sim", name="main", incarnation=sim.incarnation, sequence=0
    )
    assert [header.sequence for header in headers] == [0, 1, 2]


def test_a_message_that_cannot_be_encoded_uses_up_no_sequence_number(network: MemoryNetwork) -> None:
    with network.bus("sim") as sim:
        publisher = sim.publisher(channels.statuses(RUN, "sim", "main"))
        with pytest.raises(MessageError, match="finite"):
            publisher.send(lambda header: Status(header=header, phase="x", fraction=float("nan")))
        assert publisher.send(say("x")).header.sequence == 0


def test_each_start_is_another_incarnation(network: MemoryNetwork) -> None:
    assert len({network.bus("sim").incarnation for _ in range(3)}) == 3


def test_a_channel_is_sent_with_its_quality(network: MemoryNetwork) -> None:
    with network.bus("agent") as agent:
        action, status = channels.actions(RUN, "main"), channels.statuses(RUN, "agent", "main")
        agent.publisher(action)
        agent.publisher(status)
        assert (network.qualities[action.key], network.qualities[status.key]) == ("lockstep", "tap")


def test_injected_faults_meet_lockstep_messages_alone(network: MemoryNetwork) -> None:
    faults = Faults(probability=0.999, seed=0)
    with network.bus("agent", faults=faults) as agent, network.bus("sim") as sim:
        actions, statuses = sim.subscribe(channels.actions(RUN, "main")), sim.subscribe(channels.statuses(RUN))
        acting = agent.publisher(channels.actions(RUN, "main"))
        telling = agent.publisher(channels.statuses(RUN, "agent", "main"))
        for _ in range(20):
            acting.send(lambda header: Action(header=header, episode=1, step=2, motion=Walk()))
            telling.send(say("acting"))
        assert len(statuses.drain()) == 20
    assert len(actions.drain()) < 20


def test_a_watcher_is_told_who_is_there_and_who_comes_and_goes(network: MemoryNetwork) -> None:
    seen: list[tuple[str, str, str, bool]] = []
    with network.bus("agent") as agent:
        with network.bus("sim") as first:
            first.announce()
            agent.watch(lambda *event: seen.append(event))
            assert seen == [("sim", "main", first.incarnation, True)]
            with network.bus("planner") as second:
                second.announce()
        assert seen[1:] == [
            ("planner", "main", second.incarnation, True),
            ("planner", "main", second.incarnation, False),
            ("sim", "main", first.incarnation, False),
        ]


def test_a_process_shows_its_token_when_it_is_announced_and_not_before(network: MemoryNetwork) -> None:
    with network.bus("agent") as agent, network.bus("sim") as sim:
        assert agent.liveliness.live() == []
        sim.announce()
        assert [peer.incarnation for peer in agent.liveliness.live()] == [sim.incarnation]


def test_a_process_is_no_peer_of_its_own(network: MemoryNetwork) -> None:
    with network.bus("sim") as sim, network.bus("agent") as agent:
        sim.announce()
        agent.announce()
        assert [peer.incarnation for peer in sim.liveliness.live()] == [agent.incarnation]


def test_messages_and_tokens_of_another_run_do_not_arrive(network: MemoryNetwork) -> None:
    with network.bus("sim", run="other") as sim, network.bus("agent") as agent:
        heard = agent.subscribe(channels.statuses(RUN))
        sim.announce()
        sim.publisher(channels.statuses("other", "sim", "main")).send(say("x"))
        assert (heard.drain(), agent.liveliness.live()) == ([], [])


def test_a_token_that_names_no_process_is_counted(network: MemoryNetwork, stranger: MemorySession) -> None:
    with network.bus("sim") as sim:
        stranger.show_token(keys.liveliness(RUN, "ghost", "main", "a"))
        assert sim.tally.as_dict() == {"malformed": 1}
        assert sim.liveliness.live() == []


def test_a_peer_of_another_version_is_named_and_cannot_be_asked(
    network: MemoryNetwork, stranger: MemorySession, caplog: pytest.LogCaptureFixture
) -> None:
    with network.bus("agent") as agent:
        stranger.show_token(f"legpush/v{PROTOCOL_VERSION - 1}/{RUN}/live/sim/main/a")
        assert agent.liveliness.live() == []
        assert agent.liveliness.describe("sim", "main").startswith("of another version")
        assert agent.tally.as_dict() == {"version": 1}
    assert f"sim/main speaks protocol {PROTOCOL_VERSION - 1}, this process {PROTOCOL_VERSION}" in caplog.text


def test_what_a_peer_says_of_itself_is_known_once_its_status_is_followed(network: MemoryNetwork) -> None:
    with network.bus("agent") as agent, network.bus("sim") as sim:
        telling = sim.publisher(channels.statuses(RUN, "sim", "main"))
        sim.announce()
        telling.send(say("stepping"))
        assert "stepping" not in agent.liveliness.describe("sim")
        agent.follow("sim")
        telling.send(say("stepping"))
        assert 'it says "stepping"' in agent.liveliness.describe("sim")


def test_more_messages_than_the_inbox_holds_are_counted_and_do_not_block(
    network: MemoryNetwork, stranger: MemorySession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ports, "INBOX_SIZE", 4)
    with network.bus("sim") as sim:
        inbox = sim.subscribe(channels.actions(RUN, "main"))
        for _ in range(7):
            stranger.put(keys.action(RUN, "main"), codec.encode(MESSAGES["action_walk"]))
        assert sim.tally.as_dict() == {"overflow": 3}
        assert len(inbox.drain()) == 4


@pytest.mark.parametrize(
    ("cause", "payload"),
    [
        ("malformed", b"\xc1"),
        ("malformed", msgpack.packb({**ANY_STATUS, "surprise": 1})),
        ("malformed", msgpack.packb({**ANY_STATUS, "header": None})),
        ("malformed", status_with(protocol="1")),
        ("not_finite", msgpack.packb({**ANY_STATUS, "fraction": float("nan")})),
        ("version", status_with(protocol=PROTOCOL_VERSION + 1)),
        ("version", msgpack.packb({"header": {"protocol": PROTOCOL_VERSION + 1}, "all": "else is different"})),
        ("foreign_run", status_with(run="other")),
        ("sender", status_with(name="somebody")),
        ("sender", status_with(role="planner")),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_is_wrong_with_a_message_is_counted_by_cause_and_named_in_the_log(
    network: MemoryNetwork, stranger: MemorySession, caplog: pytest.LogCaptureFixture, cause: str, payload: bytes
) -> None:
    with network.bus("sim") as sim:
        heard = sim.subscribe(channels.statuses(RUN))
        stranger.put(keys.status(RUN, "agent", "main"), payload)
        assert sim.tally.as_dict() == {cause: 1}
        assert heard.drain() == []
        assert f"{cause} (1 so far): legpush/v{PROTOCOL_VERSION}/test/tap/agent/main/status: " in caplog.text


def test_only_an_agent_may_act(network: MemoryNetwork, stranger: MemorySession) -> None:
    with network.bus("sim") as sim:
        inbox = sim.subscribe(channels.actions(RUN, "main"))
        plain = msgpack.unpackb(codec.encode(MESSAGES["action_walk"]))
        plain["header"]["role"] = "planner"
        stranger.put(keys.action(RUN, "main"), msgpack.packb(plain))
        assert sim.tally.as_dict() == {"sender": 1}
        assert inbox.drain() == []


def test_a_recorder_is_handed_what_is_published_once_it_is_there_and_all_files(network: MemoryNetwork) -> None:
    key = keys.status(RUN, "sim", "main")
    with network.bus("recorder") as recording:
        recorder = KeptBatches(recording, "sim")
        with network.bus("sim") as sim:
            telling = sim.publisher(channels.statuses(RUN, "sim", "main"))
            sim.attach(FACT.name, FACT.media_type, FACT.data)
            telling.send(say("before"))
            recording.announce()
            telling.send(say("after"))
            assert eventually(lambda: recorder.copied() == [(key, 1)])
            telling.send(say("at the end"))
    assert recorder.copied() == [(key, 1), (key, 2)]
    assert [fact for batch in recorder.batches for fact in batch.facts] == [FACT]
    assert [batch.final for batch in recorder.batches] == [*[False] * (len(recorder.batches) - 1), True]


def test_a_process_that_is_recorded_from_its_start_on_keeps_copies_for_a_later_recorder(network: MemoryNetwork) -> None:
    with network.bus("recorder") as recording:
        recorder = KeptBatches(recording, "sim")
        with network.bus("sim", recorded=True) as sim:
            sim.publisher(channels.statuses(RUN, "sim", "main")).send(say("before"))
            recording.announce()
    assert recorder.copied() == [(keys.status(RUN, "sim", "main"), 0)]


def test_a_recorder_is_not_recorded_by_another_one(network: MemoryNetwork) -> None:
    with network.bus("recorder") as recording, network.bus("recorder", "second") as second:
        second.announce()
        assert not recording.taps.own.buffer.active


def test_bytes_can_be_put_as_they_are(network: MemoryNetwork) -> None:
    with network.bus("agent") as agent, network.bus("sim") as sim:
        sim.subscribe(channels.actions(RUN, "main"))
        agent.put(keys.action(RUN, "main"), b"\xc1")
        assert sim.tally.as_dict() == {"malformed": 1}


def test_after_an_error_within_everything_is_closed(network: MemoryNetwork) -> None:
    def work() -> None:
        with network.bus("sim") as sim:
            sim.announce()
            raise RuntimeError("mission")

    with pytest.raises(RuntimeError, match="mission"):
        work()
    assert network.sessions == []


def test_peers_are_followed_once_however_often_they_are_asked_for(network: MemoryNetwork) -> None:
    with network.bus("agent") as agent, network.bus("worker", "a") as worker:
        (session, _) = network.sessions
        agent.follow("sim", "a")
        before = len(session._subscribers)
        agent.follow("sim", "a")
        assert len(session._subscribers) == before
        agent.follow("worker")
        agent.follow("worker", "a")
        agent.follow("worker")
        assert len(session._subscribers) == before + 1
        worker.publisher(channels.statuses(RUN, "worker", "a")).send(say("working"))
        assert [peer.doing for peer in agent.liveliness.live("worker")] == []
        worker.announce()
        assert [peer.doing for peer in agent.liveliness.live("worker")] == ["working"]
