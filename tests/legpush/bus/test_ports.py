"""Publishers number their messages, subscriptions keep a bounded number of them."""

import threading

import pytest

from legpush.bus import channels, ports
from legpush.bus.ports import Publisher, Subscription
from legpush.bus.tally import Tally
from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.telemetry import Status
from tests.legpush.examples import header
from tests.legpush.fakes import RUN


def status(sequence: int) -> Status:
    return Status(header=header("sim", sequence=sequence), phase="stepping")


def test_a_message_is_noted_before_it_is_sent_with_the_very_bytes() -> None:
    happened: list[tuple[str, int, bytes]] = []
    publisher: Publisher[Status] = Publisher(
        lambda sequence: header("sim", sequence=sequence),
        lambda payload: happened.append(("sent", codec.decode(payload, Status).header.sequence, payload)),
        lambda sequence, payload: happened.append(("noted", sequence, payload)),
    )
    sent = [publisher.send(lambda header: Status(header=header, phase="x")) for _ in range(2)]
    assert [(what, sequence) for what, sequence, _ in happened] == [
        ("noted", 0),
        ("sent", 0),
        ("noted", 1),
        ("sent", 1),
    ]
    assert [payload for _, _, payload in happened[::2]] == [codec.encode(each) for each in sent]


def test_a_message_that_cannot_be_encoded_is_neither_noted_nor_sent_nor_counted() -> None:
    sent: list[bytes] = []
    publisher: Publisher[Status] = Publisher(lambda sequence: header("sim", sequence=sequence), sent.append)
    with pytest.raises(MessageError, match="finite"):
        publisher.send(lambda header: Status(header=header, phase="x", fraction=float("inf")))
    assert sent == []
    assert publisher.send(lambda header: Status(header=header, phase="x")).header.sequence == 0


def test_messages_of_several_threads_are_sent_in_the_order_of_their_numbers() -> None:
    sequences: list[int] = []
    publisher: Publisher[Status] = Publisher(
        lambda sequence: header("sim", sequence=sequence),
        lambda payload: sequences.append(codec.decode(payload, Status).header.sequence),
    )

    def send() -> None:
        for _ in range(50):
            publisher.send(lambda header: Status(header=header, phase="x"))

    threads = [threading.Thread(target=send) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sequences == list(range(200))


def test_messages_wait_in_order_and_can_be_taken_one_by_one_or_all_at_once() -> None:
    inbox = Subscription(channels.statuses(RUN), Tally())
    for sequence in range(4):
        inbox.put(status(sequence))
    first = inbox.next(0.0)
    assert first is not None
    assert first.header.sequence == 0
    assert [message.header.sequence for message in inbox.drain()] == [1, 2, 3]
    assert inbox.next(0.001) is None


def test_what_does_not_fit_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ports, "INBOX_SIZE", 2)
    tally = Tally()
    inbox = Subscription(channels.statuses(RUN), tally)
    for sequence in range(5):
        inbox.put(status(sequence))
    assert tally.as_dict() == {"overflow": 3}
    assert [message.header.sequence for message in inbox.drain()] == [0, 1]
