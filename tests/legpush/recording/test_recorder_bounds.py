"""What a recorder keeps in memory has bounds, however slow it is and however long it records."""

from legpush.bus import channels
from legpush.bus.tally import Tally
from legpush.messages.telemetry import Copies, Origin
from legpush.recording.inbox import BatchInbox
from legpush.recording.ledger import MAX_HEARD, Ledger
from tests.legpush.fakes import RUN
from tests.legpush.recording.recordings import SIM, batch, copy

PLANNER = Origin(role="planner", name="main", incarnation="planner-1")


def of_bytes(number: int, n_bytes: int) -> Copies:
    return batch(SIM, number, [copy("k", number, bytes(n_bytes))])


def test_a_batch_that_is_sent_again_waits_once() -> None:
    tally = Tally()
    inbox = BatchInbox(channels.copies(RUN), tally)
    for _ in range(5):
        inbox.put(of_bytes(0, 100))
    assert inbox.n_bytes == 100
    assert inbox.next(0.0) is not None
    assert inbox.next(0.0) is None
    inbox.put(of_bytes(0, 100))
    assert inbox.next(0.0) is not None, "its answer may be lost"
    assert inbox.n_bytes == 0
    assert tally["overflow"] == 0


def test_more_than_fits_is_refused_until_there_is_room() -> None:
    tally = Tally()
    inbox = BatchInbox(channels.copies(RUN), tally, limit_bytes=250)
    for number in range(4):
        inbox.put(of_bytes(number, 100))
    assert inbox.n_bytes == 200
    assert tally["overflow"] == 2
    assert inbox.next(0.0) is not None
    inbox.put(of_bytes(2, 100))
    waiting = [each.batch for each in inbox.drain()]
    assert waiting == [1, 2]
    inbox.put(of_bytes(5, 1000))
    assert inbox.n_bytes == 1000, "one is taken, however large"


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
