"""Batches that wait to be recorded: each once, in a bounded memory, however slow the recorder is."""

from legpush.bus import channels
from legpush.bus.tally import Tally
from legpush.messages.telemetry import Copies
from legpush.recording.inbox import BatchInbox
from tests.legpush.fakes import RUN
from tests.legpush.recording.recordings import SIM, batch, copy


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
