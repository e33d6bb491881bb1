"""Links with delay, rate and loss: what the model says of a message, and that the proxy does that."""

import json
import socket
import threading
from collections.abc import Iterator
from time import monotonic

import pytest

from benchmarks.bus.slow_link import LOOPBACK, PACKET_BYTES, Link, SlowLink
from benchmarks.bus.slow_links import linked, predicted, reported
from benchmarks.report import RESULTS
from legpush.messages.stepping import Walk
from tests.ports import free_ports

FAR = Link(delay_ms=20.0, mbit_s=10.0, loss=0.01)
DATA = bytes(range(256)) * 400


@pytest.fixture
def echo() -> Iterator[int]:
    """The port of a server that sends back what it gets."""
    with socket.create_server((LOOPBACK, 0)) as listener:

        def serve() -> None:
            connection, _ = listener.accept()
            with connection:
                while data := connection.recv(65536):
                    connection.sendall(data)

        threading.Thread(target=serve, daemon=True).start()
        yield listener.getsockname()[1]


def echoed(link: Link, to_port: int, data: bytes) -> tuple[bytes, float]:
    """What comes back over a link, and how long that took."""
    (from_port,) = free_ports(1)
    slow = SlowLink(link, from_port, to_port)
    began, back = monotonic(), bytearray()
    with socket.create_connection((LOOPBACK, from_port)) as connection:
        connection.sendall(data)
        connection.shutdown(socket.SHUT_WR)
        while chunk := connection.recv(65536):
            back += chunk
    slow.close()
    return bytes(back), monotonic() - began


def test_without_loss_a_message_takes_its_bytes_at_the_rate_and_the_delay() -> None:
    assert Link().message_s(10_000) == 0.0
    assert Link(delay_ms=20.0).message_s(10_000) == pytest.approx(0.02)
    assert Link(delay_ms=20.0, mbit_s=10.0).message_s(125_000) == pytest.approx(0.12)


def test_a_lost_packet_stalls_all_that_follow_but_not_twice() -> None:
    link = Link(delay_ms=20.0, loss=0.5)
    assert link.retransmission_s == pytest.approx(0.24)
    assert link.message_s(100) == pytest.approx(0.02 + 0.5 * 0.24)
    assert link.message_s(2 * PACKET_BYTES) == pytest.approx(0.02 + 0.75 * 0.24)


@pytest.mark.parametrize("link", [Link(), Link(delay_ms=5.0), Link(delay_ms=5.0, mbit_s=100.0, loss=0.01)])
def test_bytes_come_back_as_they_were_and_not_too_soon(link: Link, echo: int) -> None:
    back, taken_s = echoed(link, echo, DATA)
    assert back == DATA
    assert taken_s >= 2e-3 * link.delay_ms + link.sending_s(len(DATA))


def test_a_packet_that_is_lost_comes_one_retransmission_later(echo: int) -> None:
    link = Link(delay_ms=5.0, loss=1.0)
    back, taken_s = echoed(link, echo, b"one packet")
    assert back == b"one packet"
    assert taken_s >= 2 * (0.005 + link.retransmission_s)


def test_the_lockstep_goes_over_a_link_and_is_reported_beside_the_model() -> None:
    with linked(FAR, 1_000) as world:
        began = monotonic()
        assert [world.step(Walk()).world.tick for _ in range(3)]
        taken_s = monotonic() - began
    assert taken_s >= 3 * 0.04
    step_s = predicted(FAR, (300, 1_200), 0.002)
    assert step_s == pytest.approx(0.002 + FAR.message_s(300) + FAR.message_s(1_200))
    numbers = reported([0.05, 0.05], 0.04)
    assert (numbers["steps_per_s"], numbers["predicted_steps_per_s"], numbers["over_predicted"]) == (20.0, 25.0, 0.8)


def test_the_model_is_within_a_fifth_of_all_that_was_measured() -> None:
    found = json.loads((RESULTS / "slow_links.json").read_text())
    ratios = [size[link]["over_predicted"] for size in found["sizes"].values() for link in found["links"]]
    assert len(ratios) == 9
    assert all(0.8 < ratio < 1.2 for ratio in ratios)
