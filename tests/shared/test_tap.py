"""The tap of a process: what is noted, handed over, sent again, and lost."""

import threading
from collections.abc import Callable

from legpush.messages.common import Header
from legpush.messages.tap import Copies, Fact
from legpush.tap import BATCH_BYTES, Tap, TapBuffer
from tests.shared.fakes import eventually
from tests.shared.recordings import SIM, header

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
        buffer.note("k", sequence, b"before")
    buffer.start()
    buffer.meet({"r"})
    buffer.note("k", 3, b"after")
    batch = cut(buffer)
    assert batch is not None
    assert [(copy.sequence, copy.payload) for copy in batch.copies] == [(3, b"after")]
    assert [(each.key, each.n) for each in batch.published] == [("k", 4)]


def test_a_batch_stays_at_hand_until_every_recorder_has_taken_it() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    buffer.meet({"r", "s"})
    buffer.note("k", 0, b"a")
    first = cut(buffer)
    buffer.note("k", 1, b"b")
    assert not buffer.take("r", 0)
    assert cut(buffer) == first
    assert buffer.take("s", 0)
    assert sequences(cut(buffer)) == [1]
    assert not buffer.take("s", 0), "an answer to an older batch"


def test_a_recorder_that_is_gone_is_not_waited_for() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    buffer.meet({"r", "s"})
    buffer.note("k", 0, b"a")
    cut(buffer)
    buffer.meet({"r"})
    assert buffer.take("r", 0)


def test_what_is_beyond_the_limit_is_lost_and_counted() -> None:
    buffer = TapBuffer(SIM, limit_bytes=10)
    buffer.start()
    buffer.meet({"r"})
    for sequence in range(4):
        buffer.note("k", sequence, b"12345")
    batch = cut(buffer)
    assert sequences(batch) == [0, 1]
    assert batch is not None
    assert batch.published[0].n == 4
    buffer.note("k", 4, b"12345")
    buffer.take("r", 0)
    assert sequences(cut(buffer)) == [4]


def test_a_batch_has_a_size_or_one_copy_that_is_larger() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    for sequence, size in enumerate([BATCH_BYTES // 2, BATCH_BYTES // 2, 1, 2 * BATCH_BYTES]):
        buffer.note("k", sequence, bytes(size))
    got = []
    for number in range(3):
        got.append(sequences(cut(buffer)))
        buffer.take("r", number)
    assert got == [[0, 1], [2], [3]]


def test_every_new_recorder_gets_the_files() -> None:
    buffer = TapBuffer(SIM)
    buffer.attach(FACT)
    buffer.start()
    buffer.meet({"r"})
    batch = cut(buffer)
    assert batch is not None
    assert batch.facts == (FACT,)
    buffer.take("r", 0)
    assert cut(buffer) is None
    buffer.meet({"r", "s"})
    batch = cut(buffer)
    assert batch is not None
    assert batch.facts == (FACT,)


def test_the_final_batch_is_the_one_that_leaves_nothing_behind() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    buffer.note("k", 0, bytes(BATCH_BYTES))
    buffer.note("k", 1, b"b")
    finals = []
    for number in range(2):
        batch = cut(buffer, final=True)
        assert batch is not None
        finals.append(batch.final)
        buffer.take("r", number)
    assert finals == [False, True]
    assert buffer.is_empty()


class Wire:
    """What a tap sends; answers as a recorder would, or not at all."""

    def __init__(self) -> None:
        self.sent: list[Copies] = []
        self.answers = True
        self.tap = Tap(TapBuffer(SIM), self._send)

    def _send(self, build: Callable[[Header], Copies]) -> Copies:
        batch = build(header(SIM, len(self.sent)))
        self.sent.append(batch)
        if self.answers:
            threading.Thread(target=self.tap.take, args=("r", batch.batch)).start()
        return batch


def test_a_tap_says_farewell_after_everything_else() -> None:
    wire = Wire()
    wire.tap.meet({"r"})
    for sequence in range(100):
        wire.tap.buffer.note("k", sequence, b"a")
    wire.tap.close()
    assert [copy.sequence for batch in wire.sent for copy in batch.copies] == list(range(100))
    assert [batch.final for batch in wire.sent] == [*[False] * (len(wire.sent) - 1), True]


def test_what_is_not_taken_is_sent_again() -> None:
    wire = Wire()
    wire.answers = False
    wire.tap.meet({"r"})
    wire.tap.buffer.note("k", 0, b"a")
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
    wire.tap.buffer.note("k", 0, b"a")
    wire.tap.close()
    assert wire.sent == []
    assert not any(thread.name == "tap" for thread in threading.enumerate())


def test_a_recorder_that_never_answers_does_not_keep_others_from_theirs() -> None:
    buffer = TapBuffer(SIM)
    buffer.start()
    buffer.meet({"fast", "silent"})
    buffer.note("k", 0, b"a")
    first = buffer.batch()
    assert first is not None
    assert not buffer.waive(), "nobody has it"
    assert not buffer.take("fast", 0)
    buffer.note("k", 1, b"b")
    assert buffer.batch() is first
    assert buffer.waive()
    second = buffer.batch()
    assert second is not None
    assert second is not first
