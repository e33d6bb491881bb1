"""All taps of a process: its own, and those in which it stands in for others."""

from collections.abc import Callable, Iterator

import pytest

from legpush.bus import recorder_taps
from legpush.bus.recorder_taps import RecorderTaps
from legpush.messages.common import Header
from legpush.messages.telemetry import Copies, Origin, Taken
from tests.legpush.fakes import eventually
from tests.legpush.recording.recordings import AGENT, SIM, header

RECORDER = Origin(role="recorder", name="main", incarnation="recorder-1")
PLANNER = Origin(role="planner", name="main", incarnation="planner-1")


class Wire:
    """The taps of an agent, and a recorder that has what it is sent."""

    def __init__(self) -> None:
        self.sent: list[Copies] = []
        self.taps = RecorderTaps(AGENT, self._send)

    def _send(self, build: Callable[[Header], Copies]) -> Copies:
        batch = build(header(AGENT, len(self.sent)))
        self.sent.append(batch)
        taken = Taken(header=header(RECORDER, 0), origin_incarnation=batch.origin.incarnation, batch=batch.batch)
        self.taps.acknowledge_batch(taken)
        return batch

    def copied(self, origin: Origin) -> list[int]:
        """Sequences of what was handed over of a process."""
        return [copy.sequence for batch in self.sent if batch.origin == origin for copy in batch.copies]

    def finals(self) -> list[Origin]:
        """Whose farewell came, in order."""
        return [batch.origin for batch in self.sent if batch.final]


@pytest.fixture
def wire() -> Iterator[Wire]:
    """Closed in the end."""
    made = Wire()
    yield made
    made.taps.close()


def test_what_a_process_publishes_and_what_it_stands_in_for_are_handed_over_apart(wire: Wire) -> None:
    stand_in = wire.taps.stand_in_for(SIM)
    wire.taps.set_recorders({RECORDER.incarnation})
    wire.taps.own.buffer.note_message("own", 4, b"a")
    stand_in.buffer.note_message("of the simulator", 7, b"b")
    assert eventually(lambda: (wire.copied(AGENT), wire.copied(SIM)) == ([4], [7]))
    wire.taps.close_stand_in(stand_in)


def test_one_that_stands_in_knows_the_recorders_that_came_before_it(wire: Wire) -> None:
    wire.taps.set_recorders({RECORDER.incarnation})
    stand_in = wire.taps.stand_in_for(SIM)
    stand_in.buffer.note_message("k", 0, b"a")
    assert eventually(lambda: wire.copied(SIM) == [0])
    wire.taps.close_stand_in(stand_in)


def test_one_that_no_longer_stands_in_has_said_farewell_and_is_forgotten(wire: Wire) -> None:
    wire.taps.set_recorders({RECORDER.incarnation})
    stand_in = wire.taps.stand_in_for(SIM)
    stand_in.buffer.note_message("k", 0, b"a")
    wire.taps.close_stand_in(stand_in)
    assert wire.copied(SIM) == [0]
    assert wire.finals() == [SIM]
    wire.taps.acknowledge_batch(Taken(header=header(RECORDER, 1), origin_incarnation=SIM.incarnation, batch=0))


def test_only_what_a_witnessed_role_says_is_noted_and_only_while_somebody_records(wire: Wire) -> None:
    wire.taps.witness_role("planner")
    wire.taps.note_message(header(PLANNER, 0), "plan", b"before")
    wire.taps.set_recorders({RECORDER.incarnation})
    wire.taps.note_message(header(PLANNER, 1), "plan", b"a")
    wire.taps.note_message(header(SIM, 2), "sim", b"b")
    wire.taps.note_message(header(PLANNER, 3), "plan", b"c")
    assert eventually(lambda: wire.copied(PLANNER) == [1, 3])
    assert wire.copied(SIM) == []


def test_of_too_many_incarnations_the_later_ones_are_not_handed_over(
    wire: Wire, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder_taps, "MAX_HEARD", 2)
    wire.taps.witness_role("planner")
    wire.taps.set_recorders({RECORDER.incarnation})
    origins = [Origin(role="planner", name="main", incarnation=f"planner-{n}") for n in range(3)]
    for origin in origins:
        wire.taps.note_message(header(origin, 5), "plan", b"a")
    assert eventually(lambda: [wire.copied(origin) for origin in origins[:2]] == [[5], [5]])
    assert wire.copied(origins[2]) == []


def test_those_that_are_heard_say_farewell_before_the_process_itself(wire: Wire) -> None:
    wire.taps.witness_role("planner")
    wire.taps.set_recorders({RECORDER.incarnation})
    wire.taps.note_message(header(PLANNER, 0), "plan", b"a")
    wire.taps.close()
    assert wire.finals() == [PLANNER, AGENT]
