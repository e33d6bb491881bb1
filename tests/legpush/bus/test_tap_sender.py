"""The tap of a process: what is noted, handed over, sent again, and lost."""

import threading
from collections.abc import Callable

import pytest

from legpush.bus import tap_sender as tap
from legpush.bus.tap_buffer import BATCH_BYTES, LIMIT_BYTES, TapBuffer
from legpush.bus.tap_sender import Tap
from legpush.messages.common import Header
from legpush.messages.telemetry import Copies, Fact
from legpush.recording.ledger import Ledger
from tests.legpush.fakes import eventually
from tests.legpush.recording.recordings import SIM, header

FACT = Fact(name="model.xml", media_type="application/xml", data=b"<mujoco/>")


def cut(buffer: TapBuffer, *, final: bool = False) -> Copies | None:
    build = buffer.batch(final=final)
    return None if build is None else build(header(SIM, 0))


def sequences(batch: Copies | None) -> list[int]:
    assert batch is not None
    return [copy.sequence for copy in batch.copies]


def test_nothing_is_noted_before_somebody_records_but_how_much_there_was() -> None:
    buffer = TapBuffer(SIM)
    for sequence in range(3):
        buffer.note_message("k", sequence, b"before")
    buffer.start()
    buffer.set_recorders({"r"})
    buffer.note_message("k", 3, b"after")
    batch = cut(buffer)
    assert batch is not None
    assert [(copy.sequence, copy.payload) for copy in batch.copies] == [(3, b"after")]
    assert [(each.key, each.n) for each in batch.published] == [("k", 4)]


def test_a_batch_stays_at_hand_until_every_recorder_has_taken_it() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    buffer.set_recorders({"r", "s"})
    buffer.note_message("k", 0, b"a")
    first = cut(buffer)
    buffer.note_message("k", 1, b"b")
    assert not buffer.acknowledge_batch("r", 0)
    assert cut(buffer) == first
    assert buffer.acknowledge_batch("s", 0)
    assert sequences(cut(buffer)) == [1]
    assert not buffer.acknowledge_batch("s", 0), "an answer to an older batch"


def test_a_recorder_that_is_gone_is_not_waited_for() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    buffer.set_recorders({"r", "s"})
    buffer.note_message("k", 0, b"a")
    cut(buffer)
    buffer.set_recorders({"r"})
    assert buffer.acknowledge_batch("r", 0)


def test_what_is_beyond_the_limit_is_lost_and_counted() -> None:
    buffer = TapBuffer(SIM, limit_bytes=10)
    buffer.start()
    buffer.set_recorders({"r"})
    for sequence in range(4):
        buffer.note_message("k", sequence, b"12345")
    batch = cut(buffer)
    assert sequences(batch) == [0, 1]
    assert batch is not None
    assert batch.published[0].n == 4
    buffer.note_message("k", 4, b"12345")
    buffer.acknowledge_batch("r", 0)
    assert sequences(cut(buffer)) == [4]


def test_a_batch_has_a_size_or_one_copy_that_is_larger() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    for sequence, size in enumerate([BATCH_BYTES // 2, BATCH_BYTES // 2, 1, 2 * BATCH_BYTES]):
        buffer.note_message("k", sequence, bytes(size))
    got = []
    for number in range(3):
        got.append(sequences(cut(buffer)))
        buffer.acknowledge_batch("r", number)
    assert got == [[0, 1], [2], [3]]


def test_every_new_recorder_gets_the_files() -> None:
    buffer = TapBuffer(SIM)
    buffer.attach(FACT)
    buffer.start()
    buffer.set_recorders({"r"})
    batch = cut(buffer)
    assert batch is not None
    assert batch.facts == (FACT,)
    buffer.acknowledge_batch("r", 0)
    assert cut(buffer) is None
    buffer.set_recorders({"r", "s"})
    batch = cut(buffer)
    assert batch is not None
    assert batch.facts == (FACT,)


def test_the_final_batch_is_the_one_that_leaves_nothing_behind() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    buffer.note_message("k", 0, bytes(BATCH_BYTES))
    buffer.note_message("k", 1, b"b")
    finals = []
    for number in range(2):
        batch = cut(buffer, final=True)
        assert batch is not None
        finals.append(batch.final)
        buffer.acknowledge_batch("r", number)
    assert finals == [False, True]
    assert buffer.is_empty()


@pytest.mark.parametrize(("n_before", "n_lost"), [(0, 1), (0, 3), (2, 0), (2, 2)])
def test_first_messages_that_are_lost_are_missing_and_those_before_the_recorder_are_not(
    n_before: int, n_lost: int
) -> None:
    buffer, ledger = TapBuffer(SIM, limit_bytes=10), Ledger()
    for sequence in range(n_before):
        buffer.note_message("k", sequence, b"before")
    buffer.start()
    buffer.set_recorders({"r"})
    for sequence in range(n_before, n_before + n_lost):
        buffer.note_message("k", sequence, b"larger than the limit")
    buffer.note_message("k", n_before + n_lost, b"a")
    batch = cut(buffer, final=True)
    assert batch is not None
    ledger.note_batch(batch, batch.copies, {"k"})
    found = ledger.completeness()
    assert (found.n_recorded, found.n_missing, found.complete) == (1, n_lost, n_lost == 0)
    assert any("before the recording began" in note for note in found.notes) == (n_before > 0)


def test_a_key_of_which_everything_is_lost_is_missing_too() -> None:
    buffer, ledger = TapBuffer(SIM, limit_bytes=10), Ledger()
    buffer.start()
    buffer.set_recorders({"r"})
    buffer.note_message("k", 0, b"larger than the limit")
    batch = cut(buffer, final=True)
    assert batch is not None
    ledger.note_batch(batch, batch.copies, {"k"})
    assert ledger.completeness().notes == ("k of sim main (sim-1): 1 of 1 messages are missing",)


def test_a_recorder_that_joins_another_one_is_not_expected_to_have_what_that_one_got() -> None:
    buffer, late = TapBuffer(SIM), Ledger()
    buffer.start()
    buffer.set_recorders({"r"})
    for sequence in range(3):
        buffer.note_message("k", sequence, b"a")
    cut(buffer)
    buffer.acknowledge_batch("r", 0)
    buffer.set_recorders({"r", "s"})
    buffer.note_message("k", 3, b"a")
    batch = cut(buffer, final=True)
    assert batch is not None
    late.note_batch(batch, batch.copies, {"k"})
    assert late.completeness().complete
    assert late.completeness().notes == ("k of sim main (sim-1): 3 messages before the recording began",)


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


def test_a_recorder_that_never_answers_does_not_keep_others_from_theirs() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    buffer.set_recorders({"fast", "silent"})
    buffer.note_message("k", 0, b"a")
    first = buffer.batch()
    assert first is not None
    assert not buffer.skip_late_recorders(), "nobody has it"
    assert not buffer.acknowledge_batch("fast", 0)
    buffer.note_message("k", 1, b"b")
    assert buffer.batch() is first
    assert buffer.skip_late_recorders()
    second = buffer.batch()
    assert second is not None
    assert second is not first


def waived(*recorders: str) -> TapBuffer:
    """A buffer whose recorder `fast` has taken the first batch, and the others have not."""
    buffer = TapBuffer(SIM)
    buffer.attach(FACT)
    buffer.start()
    buffer.set_recorders({"fast", *recorders})
    buffer.note_message("k", 0, b"a")
    cut(buffer)
    buffer.acknowledge_batch("fast", 0)
    assert buffer.skip_late_recorders()
    return buffer


def test_a_recorder_that_went_without_a_batch_is_not_waited_for_until_it_has_caught_up() -> None:
    buffer = waived("slow")
    buffer.note_message("k", 1, b"b")
    cut(buffer)
    assert not buffer.acknowledge_batch("slow", 0), "an old one"
    assert buffer.acknowledge_batch("fast", 1)
    buffer.note_message("k", 2, b"c")
    cut(buffer)
    assert buffer.acknowledge_batch("fast", 2)
    assert not buffer.acknowledge_batch("slow", 2), "everybody has it already"
    buffer.note_message("k", 3, b"d")
    batch = cut(buffer)
    assert batch is not None
    assert batch.facts == (FACT,), "it may have gone without them"
    assert not buffer.acknowledge_batch("fast", 3), "the other one is waited for again"
    assert buffer.acknowledge_batch("slow", 3)


def test_a_recorder_that_is_left_alone_is_waited_for_even_if_it_went_without() -> None:
    buffer = waived("slow")
    buffer.set_recorders({"slow"})
    buffer.note_message("k", 1, b"b")
    assert cut(buffer) is not None
    assert not buffer.skip_late_recorders()
    assert buffer.acknowledge_batch("slow", 1)


def test_a_frozen_recorder_costs_the_others_one_wait_not_one_per_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tap, "RESEND_S", 0.02)
    wire = Wire()
    wire.tap.set_recorders({"r", "frozen"})
    for sequence in range(10):
        wire.tap.buffer.note_message("k", sequence, bytes(BATCH_BYTES))
    assert eventually(lambda: len({batch.batch for batch in wire.sent}) == 10)
    wire.tap.close()
    n_sent = [sum(batch.batch == number for batch in wire.sent) for number in range(10)]
    assert n_sent == [tap.MAX_SENT, *[1] * 9]


def test_a_frozen_recorder_is_given_up_at_once_where_notes_would_be_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tap, "RESEND_S", 0.02)
    wire = Wire(limit_bytes=4 * BATCH_BYTES)
    wire.tap.set_recorders({"r", "frozen"})
    for sequence in range(4):
        wire.tap.buffer.note_message("k", sequence, bytes(BATCH_BYTES))
    assert eventually(lambda: len({batch.batch for batch in wire.sent}) == 4)
    wire.tap.close()
    assert [sum(batch.batch == number for batch in wire.sent) for number in range(4)] == [1, 1, 1, 1]
