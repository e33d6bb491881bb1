"""What a recording should have and what it has."""

import pytest

from legpush.bus.tap_buffer import TapBuffer
from legpush.messages.telemetry import Copies, Origin
from legpush.recording.ledger import MAX_HEARD, Ledger
from tests.legpush.recording.recordings import ACTIONS, AGENT, SIM, batch, copy, header

PLANNER = Origin(role="planner", name="main", incarnation="planner-1")


def test_a_recording_of_nobody_is_not_complete() -> None:
    assert Ledger().completeness().notes == ("no process was there to be recorded",)


def test_the_ledger_knows_what_is_missing_and_what_may_be() -> None:
    ledger = Ledger()
    copies = [copy(ACTIONS, sequence, b"a") for sequence in (2, 3, 5)]
    ledger.note_process(SIM)
    ledger.note_batch(batch(AGENT, 0, copies), copies, {ACTIONS})
    found = ledger.completeness()
    assert (found.complete, found.n_recorded, found.n_missing) == (False, 3, 1)
    assert found.notes == (
        "sim main (sim-1) hands over no copies: its messages are missing",
        f"{ACTIONS} of agent main (agent-1): 1 of 4 messages are missing",
        "agent main (agent-1) did not say farewell: its last messages may be missing",
        f"{ACTIONS} of agent main (agent-1): 2 messages before the recording began",
    )


def test_what_came_before_the_recorder_is_not_expected_of_it() -> None:
    ledger = Ledger()
    copies = [copy(ACTIONS, 7, b"a")]
    ledger.note_batch(batch(AGENT, 0, copies), copies, {ACTIONS})
    found = ledger.completeness(live={"agent-1"})
    assert found.complete
    assert found.notes == (f"{ACTIONS} of agent main (agent-1): 7 messages before the recording began",)


def test_the_ledger_forgets_which_old_messages_of_a_planner_it_has() -> None:
    ledger, n = Ledger(), 5 * MAX_HEARD
    for begin in range(0, n, 1000):
        said = batch(PLANNER, begin // 1000, [copy("k", begin + k, b"a") for k in range(1000)])
        ledger.note_batch(said, ledger.fresh(said), {"k"})
    (source,) = ledger._sources.values()
    assert len(source.heard["k"]._sequences) <= 2 * MAX_HEARD
    again = batch(PLANNER, n // 1000, [copy("k", sequence, b"a") for sequence in (0, 5, n - 1, n)])
    assert [each.sequence for each in ledger.fresh(again)] == [n]
    assert ledger.completeness(live={"planner-1"}).n_missing == 0


def cut(buffer: TapBuffer, *, final: bool = False) -> Copies | None:
    build = buffer.batch(final=final)
    return None if build is None else build(header(SIM, 0))


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
