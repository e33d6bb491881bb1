"""Sessions, on Zenoh and in memory: what arrives where, who is alive, and how a process on a taken address ends."""

import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from zlib import crc32

import pytest

from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, in_directory
from legpush.bus.session import ZenohSession, checksum
from legpush.bus.transport import Session
from legpush.errors import EndpointError
from tests.legpush.bus.memory_session import RUN, MemoryNetwork
from tests.legpush.fakes import bus, eventually

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


@pytest.fixture(params=["memory", "zenoh"])
def pair(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[Session, Session]]:
    """Two sessions that are linked, of each kind."""
    if request.param == "memory":
        network = MemoryNetwork()
        yield network.open_session(Endpoints(), "one"), network.open_session(Endpoints(), "other")
        return
    address = in_directory(tmp_path, "sim").listen
    one = ZenohSession(Endpoints(listen=address), "one")
    other = ZenohSession(Endpoints(connect=address), "other")
    yield one, other
    other.close()
    one.close()


class Heard:
    """What came in a session under a key."""

    def __init__(self, session: Session, pattern: str) -> None:
        self.messages: list[tuple[str, bytes]] = []
        self.undeclare = session.subscribe(pattern, lambda key, payload: self.messages.append((key, payload)))


class Seen:
    """The tokens that came and went in a session."""

    def __init__(self, session: Session, pattern: str) -> None:
        self.tokens: list[tuple[str, bool]] = []
        self.undeclare = session.watch_tokens(pattern, lambda key, alive: self.tokens.append((key, alive)))


def link(one: Session, other: Session) -> None:
    """Wait until each hears the other."""
    heard = Heard(one, "link/one"), Heard(other, "link/other")

    def both() -> bool:
        one.put("link/other", b"")
        other.put("link/one", b"")
        return all(each.messages for each in heard)

    assert eventually(both)


def test_a_message_arrives_at_those_who_subscribe_to_its_key(pair: tuple[Session, Session]) -> None:
    one, other = pair
    exact, wild, else_where, own = (
        Heard(other, "a/x/b"),
        Heard(other, "a/*/b"),
        Heard(other, "a/*"),
        Heard(one, "a/*/b"),
    )
    link(one, other)
    sender = one.publisher("a/x/b", "lockstep")
    for payload in (b"1", b"2"):
        sender.send(payload)
    one.put("a/y/b", b"3")
    assert eventually(lambda: len(wild.messages) == 3)
    assert wild.messages == [("a/x/b", b"1"), ("a/x/b", b"2"), ("a/y/b", b"3")]
    assert eventually(lambda: len(exact.messages) == 2)
    assert exact.messages == [("a/x/b", b"1"), ("a/x/b", b"2")]
    assert (else_where.messages, own.messages) == ([], [])


def test_after_undeclaring_nothing_arrives(pair: tuple[Session, Session]) -> None:
    one, other = pair
    heard, still = Heard(other, "a"), Heard(other, "a")
    link(one, other)
    heard.undeclare()
    one.put("a", b"1")
    assert eventually(lambda: still.messages == [("a", b"1")])
    assert heard.messages == []


def test_tokens_are_seen_by_those_who_came_before_and_by_those_who_come_later(pair: tuple[Session, Session]) -> None:
    one, other = pair
    early = Seen(other, "live/*")
    hide, hide_other = one.show_token("live/a"), one.show_token("dead/a")
    assert eventually(lambda: early.tokens == [("live/a", True)])
    late = Seen(other, "live/*")
    assert eventually(lambda: late.tokens == [("live/a", True)])
    late.undeclare()
    hide_other()
    hide()
    assert eventually(lambda: early.tokens == [("live/a", True), ("live/a", False)])
    assert late.tokens == [("live/a", True)]


def test_the_tokens_of_a_session_go_when_it_is_closed(pair: tuple[Session, Session]) -> None:
    one, other = pair
    seen = Seen(one, "live/*")
    hide = other.show_token("live/a")
    assert eventually(lambda: seen.tokens == [("live/a", True)])
    other.close()
    assert eventually(lambda: seen.tokens == [("live/a", True), ("live/a", False)])
    del hide


def test_a_second_process_on_the_same_socket_has_one_clear_error(tmp_path: Path) -> None:
    with (
        bus(tmp_path, "sim"),
        pytest.raises(EndpointError, match=r"listen on unixsock-stream/.*sim\.sock as sim main") as raised,
        bus(tmp_path, "sim"),
    ):
        pass
    assert "not possible: another process listens there (" in str(raised.value)


def cannot_listen(locator: str) -> str:
    """Why a process cannot listen there."""
    with (
        pytest.raises(EndpointError, match=f"listen on {re.escape(locator)}, but|as sim main, but") as raised,
        Bus(RUN, "sim", "main", Endpoints(listen=(locator,))),
    ):
        pass
    assert ".rs" not in str(raised.value)
    return str(raised.value).partition("not possible: ")[2]


def test_a_second_process_on_the_same_port_is_told_the_flag_for_another_one() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        why = cannot_listen(f"tcp/127.0.0.1:{server.getsockname()[1]}")
    assert why.startswith("another process listens there; choose another port with --listen (")
    assert why.endswith("Address already in use (os error 98)])")


@pytest.mark.parametrize(
    ("locator", "guess", "words"),
    [
        ("unixsock-stream/{folder}/none/sim.sock", "the directory does not exist", "ENOENT: No such file or directory"),
        ("unixsock-stream/{folder}/file/sim.sock", "", "ENOTDIR: Not a directory"),
        ("tcp/127.0.0.1:0#iface=nope0", "", "No such device"),
        ("tcp/203.0.113.1:17999", "", "Cannot assign requested address"),
    ],
)
def test_only_a_known_cause_is_named_beside_what_the_system_says(
    locator: str, guess: str, words: str, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    why = cannot_listen(locator.format(folder=tmp_path))
    assert words in why
    if guess:
        assert why.startswith(f"{guess} (")
    else:
        assert "another process" not in why
        assert "directory does not exist" not in why


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


DAMAGE = {
    "none": (b"payload", b"payload", 1),
    "a bit of the payload": (b"payload", b"payloae", 0),
    "its end": (b"payload", b"payloa", 0),
    "everything": (b"payload", b"", 0),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_message_that_does_not_fit_its_checksum_is_not_heard(tmp_path: Path, damage: str) -> None:
    sent, arrived, n_heard = DAMAGE[damage]
    address = in_directory(tmp_path, "sim").listen
    one, other = ZenohSession(Endpoints(listen=address), "one"), ZenohSession(Endpoints(connect=address), "other")
    link(one, other)
    heard, damaged = list[bytes](), list[str]()
    undeclare = other.subscribe("a/b", lambda key, payload: heard.append(payload), damaged.append)
    network: Any = one._session

    def arrives() -> bool:
        one.put("a/b", b"without a checksum")
        return bool(heard)

    assert eventually(arrives)
    heard.clear()
    network.put("a/b", arrived, attachment=checksum("a/b", sent))
    network.put("a/b", b"payload", attachment=checksum("a/c", b"payload"))  # under another key than it was sent
    assert eventually(lambda: len(damaged) == 2 - n_heard)
    assert [each for each in heard if each != b"without a checksum"] == [arrived] * n_heard
    undeclare()
    other.close()
    one.close()


def test_every_message_of_a_publisher_has_its_checksum(tmp_path: Path) -> None:
    address = in_directory(tmp_path, "sim").listen
    one, other = ZenohSession(Endpoints(listen=address), "one"), ZenohSession(Endpoints(connect=address), "other")
    attached: list[bytes] = []
    network: Any = other._session
    subscriber = network.declare_subscriber("a/b", lambda sample: attached.append(sample.attachment.to_bytes()))
    sender = one.publisher("a/b", "lockstep")

    def arrives() -> bool:
        sender.send(b"payload")
        return bool(attached)

    assert eventually(arrives)
    assert attached[0] == checksum("a/b", b"payload") == bytes.fromhex(f"{crc32(b'a/bpayload'):08x}")
    subscriber.undeclare()
    other.close()
    one.close()
