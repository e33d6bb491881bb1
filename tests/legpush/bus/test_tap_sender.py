"""The thread of a tap: when it hands batches over, when it sends them again, and how it ends."""

import threading
from collections.abc import Callable

import pytest

from legpush.bus import tap_sender
from legpush.bus.tap_buffer import BATCH_BYTES, LIMIT_BYTES, TapBuffer
from legpush.bus.tap_sender import Tap
from legpush.messages.common import Header
from legpush.messages.telemetry import Copies
from tests.legpush.fakes import eventually
from tests.legpush.recording.recordings import SIM, header


class Wire:
    """What a tap sends; answers as a recorder would, or not at all."""

    def __init__(self, limit_bytes: int = LIMIT_BYTES) -> None:
        self.sent: list[Copies] = []
        self.answers = True
        self.tap = Tap(TapBuffer(SIM, limit_bytes), self._send)

    def _send(self, build: Callable[[Header], Copies]) -> Copies:
        batch = build(header(SIM, len(self.sent)))
        self.sent.append(batch)
        if self.answers:
            threading.Thread(target=self.tap.acknowledge_batch, args=("r", batch.batch)).start()
        return batch


def test_a_tap_says_farewell_after_everything_else() -> None:
    wire = Wire()
    wire.tap.set_recorders({"r"})
    for sequence in range(100):
        wire.tap.buffer.note_message("k", sequence, b"a")
    wire.tap.close()
    assert [copy.sequence for batch in wire.sent for copy in batch.copies] == list(range(100))
    assert [batch.final for batch in wire.sent] == [*[False] * (len(wire.sent) - 1), True]


def test_what_is_not_taken_is_sent_again() -> None:
    wire = Wire()
    wire.answers = False
    wire.tap.set_recorders({"r"})
    wire.tap.buffer.note_message("k", 0, b"a")
    assert eventually(lambda: len(wire.sent) >= 2)
    assert wire.sent[0] == wire.sent[1].__class__(
        **{name: getattr(wire.sent[1], name) for name in wire.sent[1].__struct_fields__ if name != "header"},
        header=wire.sent[0].header,
    )
    wire.answers = True
    wire.tap.close()
    assert wire.sent[-1].final


def test_a_process_that_nobody_records_has_no_thread_for_it() -> None:
    wire = Wire()
    wire.tap.buffer.note_message("k", 0, b"a")
    wire.tap.close()
    assert wire.sent == []
    assert not any(thread.name == "tap" for thread in threading.enumerate())


def test_a_frozen_recorder_costs_the_others_one_wait_not_one_per_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tap_sender, "RESEND_S", 0.02)
    wire = Wire()
    wire.tap.set_recorders({"r", "frozen"})
    for sequence in range(10):
        wire.tap.buffer.note_message("k", sequence, bytes(BATCH_BYTES))
    assert eventually(lambda: len({batch.batch for batch in wire.sent}) == 10)
    wire.tap.close()
    n_sent = [sum(batch.batch == number for batch in wire.sent) for number in range(10)]
    assert n_sent == [tap_sender.MAX_SENT, *[1] * 9]


def test_a_frozen_recorder_is_given_up_at_once_where_notes_would_be_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tap_sender, "RESEND_S", 0.02)
    wire = Wire(limit_bytes=4 * BATCH_BYTES)
    wire.tap.set_recorders({"r", "frozen"})
    for sequence in range(4):
        wire.tap.buffer.note_message("k", sequence, bytes(BATCH_BYTES))
    assert eventually(lambda: len({batch.batch for batch in wire.sent}) == 4)
    wire.tap.close()
    assert [sum(batch.batch == number for batch in wire.sent) for number in range(4)] == [1, 1, 1, 1]
