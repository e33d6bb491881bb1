"""The buffer of a tap: what is noted, handed over, waited for, and lost."""

from legpush.bus.tap_buffer import BATCH_BYTES, TapBuffer
from legpush.messages.telemetry import Copies, Fact
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
