"""Asking one peer, with a clock and a liveliness that are set by hand: when it asks again, and when it gives up."""

from collections.abc import Callable
from functools import partial
from itertools import count, pairwise
from threading import Event

import pytest
from msgspec.structs import replace

from legpush.bus.exchange import Exchange
from legpush.bus.liveliness import Liveliness
from legpush.bus.tally import Tally
from legpush.errors import PeerError, PeerGoneError, StopRequestedError
from legpush.messages.common import Role
from legpush.messages.stepping import Answer, Refusal
from legpush.patience import Patience
from tests.legpush.examples import MESSAGES
from tests.legpush.fakes import Clock

PATIENCE = Patience(deadline_s=10.0, resend_s=0.25, resend_at_most_s=1.0, max_restarts=2, leave_s=4.0, rival_s=3.0)
ANSWER = MESSAGES["refusal"]


class Table:
    """Bus, inbox and script in one: each look into the inbox moves the clock and lets the script happen."""

    def __init__(self) -> None:
        self.clock = Clock()
        self.liveliness = Liveliness(self.clock)
        self.tally = Tally()
        self.sent_at_s: list[float] = []
        self.waits: list[str] = []
        self.inbox: list[Answer] = []
        self.events: list[tuple[float, Callable[[], object]]] = []
        self.stop = Event()
        self.somebody_else = False
        self._sequences = count()
        self.exchange: Exchange[Answer] = Exchange(
            self,  # type: ignore[arg-type]
            self,  # type: ignore[arg-type]
            ("sim", "main"),
            PATIENCE,
            self.stop,
            self.waits.append,
            self.clock,
            lambda: self.somebody_else,
        )

    def follow(self, role: Role, name: str | None) -> None:
        assert (role, name) == ("sim", "main")

    def next(self, timeout_s: float) -> Answer | None:
        assert 0.0 < timeout_s <= 0.05
        self.clock.now_s += timeout_s
        while self.events and self.clock.now_s - 100.0 >= self.events[0][0]:
            self.events.pop(0)[1]()
        return self.inbox.pop(0) if self.inbox else None

    def at(self, seconds: float, happens: Callable[[], object]) -> None:
        """Let something happen, in the order of time."""
        self.events.append((seconds, happens))

    def token(self, incarnation: str, alive: bool = True) -> None:
        self.liveliness.note_token("sim", "main", incarnation, alive)

    def replace(self, old: str, new: str) -> None:
        """One incarnation dies, another one is started."""
        self.token(old, alive=False)
        self.token(new)

    def answer(self, incarnation: str, step: int = 9, sequence: int | None = None, reason: str = "") -> None:
        assert isinstance(ANSWER, Refusal)
        number = next(self._sequences) if sequence is None else sequence
        header = replace(ANSWER.header, incarnation=incarnation, sequence=number)
        self.inbox.append(replace(ANSWER, header=header, step=step, reason=reason))

    def ask(self) -> Answer:
        return self.exchange.ask("step 9", self._send, lambda answer: answer.step == 9)

    def _send(self) -> None:
        self.sent_at_s.append(round(self.clock.now_s - 100.0, 2))


@pytest.fixture
def table() -> Table:
    """Nobody is there yet."""
    return Table()


def test_nothing_is_sent_to_nobody(table: Table) -> None:
    with pytest.raises(PeerError, match=r"No answer to step 9 within 10 s; sim/main is not there"):
        table.ask()
    assert table.sent_at_s == []


def test_a_question_is_sent_as_soon_as_the_peer_is_there_and_again_at_growing_intervals(table: Table) -> None:
    table.at(2.0, lambda: table.token("a"))
    table.at(6.0, lambda: table.answer("a"))
    table.ask()
    assert table.sent_at_s == pytest.approx([2.0, 2.25, 2.75, 3.75, 4.75, 5.75], abs=0.051)


def test_a_new_link_to_the_same_peer_is_used_at_once(table: Table) -> None:
    table.token("a")
    table.at(1.0, lambda: table.token("a", alive=False))
    table.at(1.0, lambda: table.token("a"))
    table.at(1.1, lambda: table.answer("a"))
    table.ask()
    assert table.sent_at_s == pytest.approx([0.0, 0.25, 0.75, 1.0], abs=0.051)


def test_an_answer_of_another_incarnation_is_dropped_even_if_it_fits(table: Table) -> None:
    table.token("a")
    table.answer("b")
    table.at(1.0, lambda: table.answer("a"))
    assert table.ask().header.incarnation == "a"
    assert table.tally.as_dict() == {"late": 1}


def test_an_answer_that_does_not_fit_is_dropped(table: Table) -> None:
    table.token("a")
    table.answer("a", step=8)
    table.answer("a", step=9)
    assert isinstance(answer := table.ask(), Refusal)
    assert answer.step == 9
    assert table.tally.as_dict() == {"late": 1}


def test_an_answer_that_was_under_way_when_its_sender_died_counts(table: Table) -> None:
    table.token("a")
    table.at(0.5, lambda: table.token("a", alive=False))
    table.at(1.0, lambda: table.answer("a"))
    assert table.ask().header.incarnation == "a"


def test_the_deadline_begins_anew_with_a_new_incarnation(table: Table) -> None:
    table.token("a")
    table.at(9.0, lambda: table.replace("a", "b"))
    table.at(18.0, lambda: table.answer("b"))
    assert table.ask().header.incarnation == "b"


def test_the_deadline_does_not_begin_anew_with_a_new_link(table: Table) -> None:
    table.token("a")
    table.at(9.0, lambda: table.token("a", alive=False))
    table.at(9.0, lambda: table.token("a"))
    with pytest.raises(PeerError, match="within 10 s"):
        table.ask()
    assert table.clock.now_s - 100.0 == pytest.approx(10.0, abs=0.1)


def test_time_in_which_this_process_was_paused_does_not_count(table: Table) -> None:
    table.token("a")
    table.at(5.0, lambda: setattr(table.clock, "now_s", 4000.0))
    table.at(3904.0, lambda: table.answer("a"))
    assert table.ask().header.incarnation == "a"


def test_a_peer_that_is_started_anew_too_often_is_given_up(table: Table) -> None:
    table.token("a")
    for index, (old, new) in enumerate(pairwise("abcd")):
        table.at(1.0 + index, partial(table.replace, old, new))
    with pytest.raises(PeerError, match="sim/main was restarted 3 times without an answer to step 9"):
        table.ask()


def test_restarts_are_forgiven_when_the_peer_has_done_what_it_was_asked(table: Table) -> None:
    table.token("a")
    for old, new in pairwise("abcde"):
        table.answer(old)
        table.ask()
        table.exchange.forgive_restarts()
        table.replace(old, new)
    table.answer("e")
    assert table.ask().header.incarnation == "e"


def test_two_live_peers_of_one_name_are_not_asked_and_given_up_after_a_while(table: Table) -> None:
    table.token("a")
    table.token("b")
    with pytest.raises(PeerError, match=r"one process, .* is several processes, 2 of them \(a, b\)"):
        table.ask()
    assert table.sent_at_s == []
    assert table.clock.now_s - 100.0 == pytest.approx(3.0, abs=0.1)


def test_a_peer_that_has_answered_is_asked_on_beside_a_rival(table: Table, caplog: pytest.LogCaptureFixture) -> None:
    table.token("a")
    table.answer("a")
    table.ask()
    table.token("b")
    table.at(5.0, lambda: table.answer("b"))
    table.at(8.0, lambda: table.answer("a"))
    assert table.ask().header.incarnation == "a"
    assert table.tally.as_dict() == {"late": 1}
    assert caplog.text.count("several processes, 2 of them (a, b); keeping to a, which has answered before") == 1


def test_a_rival_that_was_met_while_the_peer_was_cut_off_is_left_again(table: Table) -> None:
    table.token("a")
    table.answer("a")
    table.ask()
    table.token("b")
    table.token("a", alive=False)
    table.at(4.0, lambda: table.token("a"))
    table.at(5.0, lambda: table.answer("a"))
    assert table.ask().header.incarnation == "a"


def test_a_peer_that_stops_answering_beside_a_rival_is_given_up_after_the_deadline(table: Table) -> None:
    table.token("a")
    table.answer("a")
    table.ask()
    table.token("b")
    with pytest.raises(PeerError, match=r"within 10 s; sim/main is several processes, 2 of them \(a, b\)"):
        table.ask()


@pytest.mark.parametrize(("reason", "cause"), [("", "late"), ("forged", "repeated")], ids=["copy", "forged"])
def test_an_answer_with_the_sequence_of_an_accepted_one_is_not_taken(table: Table, reason: str, cause: str) -> None:
    table.token("a")
    table.answer("a", sequence=7)
    table.ask()
    table.answer("a", sequence=7, reason=reason)
    table.answer("a", sequence=6, reason=reason)
    table.at(2.0, lambda: table.answer("a", sequence=8, reason="true"))
    assert isinstance(answer := table.ask(), Refusal)
    assert answer.reason == "true"
    assert table.tally.as_dict() == ({"late": 2} if cause == "late" else {"repeated": 1, "late": 1})


def test_a_dead_peer_that_lingers_does_not_count_as_a_second_one(table: Table) -> None:
    table.token("a")
    table.token("b")
    table.at(2.0, lambda: table.token("a", alive=False))
    table.at(9.0, lambda: table.answer("b"))
    table.ask()
    assert table.sent_at_s[0] == pytest.approx(2.0, abs=0.051)


def test_a_long_wait_is_reported_once_per_second_and_its_end_too(table: Table) -> None:
    table.token("a")
    table.at(3.5, lambda: table.answer("a"))
    table.ask()
    assert [wait != "" for wait in table.waits] == [True, True, True, False]
    assert table.waits[0] == "step 9: sim/main is slow: it is alive, no message from it yet"


def test_a_short_wait_is_not_reported(table: Table) -> None:
    table.token("a")
    table.at(0.9, lambda: table.answer("a"))
    table.ask()
    assert table.waits == []


def test_a_wait_ends_when_the_process_is_asked_to_stop(table: Table) -> None:
    table.at(1.0, table.stop.set)
    with pytest.raises(StopRequestedError, match="waiting for the answer to step 9; sim/main is not there"):
        table.ask()


def test_a_peer_that_is_gone_is_left_once_there_is_somebody_else(table: Table) -> None:
    table.token("a")
    table.at(2.0, partial(table.token, "a", alive=False))
    table.at(7.0, partial(setattr, table, "somebody_else", True))

    with pytest.raises(PeerGoneError, match=r"No answer to step 9; sim/main is frozen or cut off"):
        table.ask()
    assert table.clock.now_s == pytest.approx(107.0, abs=0.1)


def test_a_peer_that_is_gone_for_a_moment_or_only_slow_is_not_left(table: Table) -> None:
    table.somebody_else = True
    table.token("a")
    table.at(2.0, partial(table.token, "a", alive=False))
    table.at(5.0, partial(table.token, "a"))
    table.at(9.5, partial(table.answer, "a"))

    assert table.ask().step == 9
