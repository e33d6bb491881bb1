"""The simulators' end of bundles: several simulators of one process, over one session."""

import threading
from collections import defaultdict, deque
from functools import partial
from typing import Final

from legpush.bus import keys
from legpush.bus.bundles.collector import MAX_PART_BYTES, Collector
from legpush.bus.bundles.forwarding import ForwardingSession, SharedSession
from legpush.bus.bundles.question import Question, answered_in, asked_in
from legpush.bus.bundles.taking import take_bundles
from legpush.bus.channels import Quality
from legpush.bus.tally import Tally
from legpush.bus.transport import OnBytes, OnDamaged, Sender, Session, Undeclare, ignore
from legpush.messages import codec
from legpush.messages.bundle import Bundle, Part

MOST_ASKED: Final = 16
"""Of each simulator, as many questions are kept that came in bundles and have no answer yet. Some never get one."""


class AnsweringSession:
    """One session of all simulators of this process. What is asked in a bundle is answered in one, and the rest alone.

    `tally` counts the bundles that were refused.
    """

    def __init__(self, session: Session, run: str, process: str) -> None:
        """`process` is the part of their incarnations that the simulators have in common."""
        self.tally = Tally()
        self._session = session
        self._run = run
        self._own: set[str] = set()
        """The tokens of all simulators of this process."""
        self._lock = threading.Lock()
        self._asked: defaultdict[str, deque[Question]] = defaultdict(partial(deque, maxlen=MOST_ASKED))
        """By the name of a simulator, what it was asked in bundles and has not answered."""
        self._take: dict[str, tuple[str, OnBytes]] = {}
        """By the key of its actions, the name of a simulator and what takes them."""
        answers = session.publisher(keys.bundled_answers(run, process), "lockstep")
        self._collector = Collector(lambda bundle: answers.send(codec.encode(bundle)))
        take_bundles(session, keys.bundled_actions(run, process), self.tally, self._take_bundle)

    def member(self, name: str) -> Session:
        """Return the session of the simulator with this name; closing it does not close this one."""
        return _Member(self, SharedSession(self._session, self._own), self._run, name)

    def close(self) -> None:
        """Close all links."""
        self._session.close()

    def take_actions(self, name: str, on_bytes: OnBytes) -> Undeclare:
        """Let `on_bytes` take the actions for this simulator that come in bundles."""
        key = keys.action(self._run, name)
        self._take[key] = name, on_bytes
        return partial(_remove, self._take, key)

    def answer(self, name: str, part: Part, alone: Sender) -> None:
        """Send an answer of this simulator as it was asked: with those of others, or alone."""
        if self._was_in_bundle(name, part.payload) and len(part.payload) <= MAX_PART_BYTES:
            self._collector.put(name, part)
        else:
            self._collector.forget(name)
            alone.send(part.payload)

    def _was_in_bundle(self, name: str, answer: bytes) -> bool:
        """Whether the question that this answers came in a bundle; if it is answered again, that goes alone."""
        with self._lock:
            asked = self._asked[name]
            question = answered_in(answer) if asked else None
            if question is None or question not in asked:
                return False
            asked.remove(question)
            return True

    def _take_bundle(self, key: str, bundle: Bundle) -> None:
        taken = [(part, self._take.get(part.key)) for part in bundle.parts]
        for part, taker in taken:
            if taker is None:
                self.tally.add("unknown", f"{key}: expected actions for simulators of this process, got {part.key!r}")
            else:
                self._note_question(taker[0], part.payload)
        for part, taker in taken:
            if taker is not None:
                taker[1](part.key, part.payload)

    def _note_question(self, name: str, payload: bytes) -> None:
        """Expect the answer of this simulator to a question in a bundle, unless these bytes are no question."""
        question = asked_in(payload)
        if question is None:
            return
        with self._lock:
            if question not in self._asked[name]:
                self._asked[name].append(question)
        self._collector.expect(name)


def _remove(takers: dict[str, tuple[str, OnBytes]], key: str) -> None:
    takers.pop(key, None)


class _Member(ForwardingSession):
    """The session of one simulator."""

    def __init__(self, shared: AnsweringSession, session: SharedSession, run: str, name: str) -> None:
        super().__init__(session)
        self._shared = shared
        self._name = name
        self._actions, self._answers = keys.action(run, name), keys.observation(run, name)

    def publisher(self, key: str, quality: Quality) -> Sender:
        """Sends bytes under `key`; answers may travel with those of other simulators."""
        alone = super().publisher(key, quality)
        if key != self._answers:
            return alone

        def send(payload: bytes) -> None:
            self._shared.answer(self._name, Part(key=key, payload=payload), alone)

        return Sender(send, alone.undeclare)

    def subscribe(self, key: str, on_bytes: OnBytes, on_damaged: OnDamaged = ignore) -> Undeclare:
        """Call `on_bytes` for everything that other processes publish under `key`, alone or in a bundle."""
        undeclare = super().subscribe(key, on_bytes, on_damaged)
        if key != self._actions:
            return undeclare
        leave = self._shared.take_actions(self._name, on_bytes)

        def undeclare_both() -> None:
            leave()
            undeclare()

        return undeclare_both
