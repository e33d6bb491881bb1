"""The bus on a real link: headers, quality of service, who is there, and everything that must not come through."""

import json
import queue
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgpack
import pytest
import zenoh

from legpush.bus import channels, keys, ports
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, in_directory
from legpush.errors import EndpointError, MessageError
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Header
from legpush.messages.telemetry import Status
from tests.legpush.examples import MESSAGES
from tests.legpush.fakes import RUN, bus, eventually

HOLD_SOCKET = """
import sys, time
from pathlib import Path
from legpush.bus.bus import Bus
from legpush.bus.endpoints import in_directory
with Bus("test", "sim", "main", in_directory(Path(sys.argv[1]), "sim")) as bus:
    bus.announce()
    print("ready", flush=True)
    sys.stdin.read()
"""


def say(phase: str) -> Callable[[Header], Status]:
    """A status to send."""
    return lambda header: Status(header=header, phase=phase)


@contextmanager
def raw_session(directory: Path) -> Iterator[zenoh.Session]:
    """Zenoh as anybody could use it, connected to the simulator."""
    config = zenoh.Config()
    settings: dict[str, Any] = {
        "mode": "peer",
        "listen/endpoints": [],
        "connect/endpoints": list(in_directory(directory, "sim").listen),
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "open/return_conditions/connect_scouted": False,
    }
    for path, value in settings.items():
        config.insert_json5(path, json.dumps(value))
    with zenoh.open(config) as session:
        yield session


def put(session: zenoh.Session, key: str, payload: bytes) -> None:
    """Put once somebody listens."""
    publisher = session.declare_publisher(key)
    assert eventually(lambda: publisher.matching_status.matching)  # type: ignore[attr-defined]
    publisher.put(payload)


@pytest.fixture
def pair(tmp_path: Path) -> Iterator[tuple[Bus, Bus]]:
    """A simulator and an agent that see each other."""
    with bus(tmp_path, "sim") as sim, bus(tmp_path, "agent") as agent:
        sim.announce()
        assert eventually(lambda: len(agent.liveliness.live("sim")) == 1)
        yield sim, agent


def test_every_header_says_who_and_counts_the_messages_of_its_key(pair: tuple[Bus, Bus]) -> None:
    sim, agent = pair
    heard = agent.subscribe(channels.statuses(RUN))
    publisher = sim.publisher(channels.statuses(RUN, "sim", "main"))
    first = publisher.send(say("0"))
    assert eventually(lambda: publisher.send(say("more")).header.sequence > 0 and heard.next(0.01) is not None)
    assert first.header == Header(
        protocol=PROTOCOL_VERSION, run=RUN, role="sim", name="main", incarnation=sim.incarnation, sequence=0
    )
    sequences = [message.header.sequence for message in heard.drain()]
    assert sequences == sorted(set(sequences))


def test_a_message_that_cannot_be_encoded_uses_up_no_sequence_number(pair: tuple[Bus, Bus]) -> None:
    publisher = pair[0].publisher(channels.statuses(RUN, "sim", "main"))
    with pytest.raises(MessageError, match="finite"):
        publisher.send(lambda header: Status(header=header, phase="x", fraction=float("nan")))
    assert publisher.send(say("x")).header.sequence == 0


def test_a_watcher_is_told_who_is_there_and_who_comes_and_goes(tmp_path: Path) -> None:
    seen: queue.Queue[tuple[str, str, str, bool]] = queue.Queue()
    with bus(tmp_path, "agent") as agent:
        with bus(tmp_path, "sim") as sim:
            sim.announce()
            assert eventually(lambda: len(agent.liveliness.live("sim")) == 1)
            agent.watch(lambda *event: seen.put(event))
            assert seen.get(timeout=10.0) == ("sim", "main", sim.incarnation, True)
        assert seen.get(timeout=10.0) == ("sim", "main", sim.incarnation, False)


def test_a_process_is_not_on_its_own_roster(pair: tuple[Bus, Bus]) -> None:
    sim, agent = pair
    agent.announce()
    assert eventually(lambda: len(sim.liveliness.live()) == 1)
    assert [sighting.incarnation for sighting in sim.liveliness.live()] == [agent.incarnation]


def test_own_messages_do_not_come_back(pair: tuple[Bus, Bus]) -> None:
    sim, agent = pair
    own, others = sim.subscribe(channels.statuses(RUN)), agent.subscribe(channels.statuses(RUN))
    publisher = sim.publisher(channels.statuses(RUN, "sim", "main"))
    assert eventually(lambda: publisher.send(say("x")) is not None and others.next(0.01) is not None)
    assert own.drain() == []


def test_messages_and_tokens_of_another_run_do_not_arrive(tmp_path: Path) -> None:
    with Bus("other", "sim", "main", in_directory(tmp_path, "sim")) as sim, bus(tmp_path, "agent") as agent:
        sim.announce()
        with Bus("other", "agent", "second", Endpoints(connect=in_directory(tmp_path, "sim").listen)) as second:
            assert eventually(lambda: len(second.liveliness.live("sim")) == 1)
        assert agent.liveliness.live() == []


def test_a_token_that_names_no_process_is_counted(tmp_path: Path) -> None:
    with bus(tmp_path, "sim") as sim, raw_session(tmp_path) as session:
        with session.liveliness().declare_token(keys.liveliness(RUN, "ghost", "main", "a")):
            assert eventually(lambda: sim.tally["malformed"] > 0)
        assert sim.liveliness.live() == []


def test_more_messages_than_the_inbox_holds_are_counted_and_do_not_block(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ports, "INBOX_SIZE", 4)
    with bus(tmp_path, "sim") as sim, raw_session(tmp_path) as session:
        inbox = sim.subscribe(channels.actions(RUN, "main"))
        payload = codec.encode(MESSAGES["action_walk"])
        key = keys.action(RUN, "main")
        assert eventually(lambda: session.put(key, payload) is None and sim.tally["overflow"] >= 3)
        assert len(inbox.drain()) == 4


ANY_STATUS: dict[str, Any] = msgpack.unpackb(codec.encode(MESSAGES["status"]))


def status_with(**header: object) -> bytes:
    """A status whose header differs in these fields."""
    packed: bytes = msgpack.packb({**ANY_STATUS, "header": {**ANY_STATUS["header"], **header}})
    return packed


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
    tmp_path: Path, caplog: pytest.LogCaptureFixture, cause: str, payload: bytes
) -> None:
    with bus(tmp_path, "sim") as sim, raw_session(tmp_path) as session:
        heard = sim.subscribe(channels.statuses(RUN))
        put(session, keys.status(RUN, "agent", "main"), payload)
        assert eventually(lambda: sim.tally.as_dict() != {})
        assert sim.tally.as_dict() == {cause: 1}
        assert heard.drain() == []
        text = f"{cause} (1 so far): legpush/v{PROTOCOL_VERSION}/test/tap/agent/main/status: "
        assert eventually(lambda: text in caplog.text)


def test_only_an_agent_may_act(tmp_path: Path) -> None:
    with bus(tmp_path, "sim") as sim, raw_session(tmp_path) as session:
        sim.subscribe(channels.actions(RUN, "main"))
        plain = msgpack.unpackb(codec.encode(MESSAGES["action_walk"]))
        plain["header"]["role"] = "planner"
        put(session, keys.action(RUN, "main"), msgpack.packb(plain))
        assert eventually(lambda: sim.tally["sender"] == 1)


def test_a_second_process_on_the_same_socket_has_one_clear_error(tmp_path: Path) -> None:
    with (
        bus(tmp_path, "sim"),
        pytest.raises(EndpointError, match=r"listen on unixsock-stream/.*sim\.sock as sim main"),
        bus(tmp_path, "sim"),
    ):
        pass


def test_a_second_process_on_the_same_port_has_one_clear_error() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        locator = f"tcp/127.0.0.1:{server.getsockname()[1]}"
        with (
            pytest.raises(EndpointError, match=f"listen on {locator}"),
            Bus(RUN, "sim", "main", Endpoints(listen=(locator,))),
        ):
            pass


def test_a_socket_left_behind_by_a_killed_process_is_taken_over(tmp_path: Path) -> None:
    command = [sys.executable, "-c", HOLD_SOCKET, str(tmp_path)]
    with (
        bus(tmp_path, "agent") as agent,
        subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process,
    ):
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        assert eventually(lambda: len(agent.liveliness.live("sim")) == 1)
        process.send_signal(signal.SIGKILL)
        process.wait(10.0)
        assert (tmp_path / "sim.sock").exists()
        assert eventually(lambda: agent.liveliness.live("sim") == [])
        with bus(tmp_path, "sim") as sim:
            sim.announce()
            assert eventually(lambda: [s.incarnation for s in agent.liveliness.live("sim")] == [sim.incarnation])


def test_a_bus_can_be_opened_again_after_an_error_within(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="mission"), bus(tmp_path, "sim"):
        raise RuntimeError("mission")
    with bus(tmp_path, "sim") as sim:
        assert sim.tally.as_dict() == {}
