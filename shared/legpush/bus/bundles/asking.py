"""The agent's end of bundles: simulators of one process are asked together."""

import logging
import threading
from collections import Counter, defaultdict
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Final

from legpush.bus import keys
from legpush.bus.bundles.collector import MAX_PART_BYTES, Collector
from legpush.bus.bundles.forwarding import ForwardingSession
from legpush.bus.bundles.question import Question, asked_in
from legpush.bus.bundles.taking import take_bundles
from legpush.bus.channels import Quality
from legpush.bus.keys import parse_token
from legpush.bus.tally import Tally
from legpush.bus.transport import OnBytes, OnDamaged, OnToken, Sender, Session, Undeclare, ignore
from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.bundle import Bundle, Part
from legpush.messages.common import PROTOCOL_VERSION

log = logging.getLogger(__name__)

MOST_STRAYS: Final = 3
"""A process gets no bundles any more after as many questions in a row to one of its simulators, if nothing shows that
these bundles arrived.
"""


@dataclass
class _Process:
    """A process with several simulators."""

    collector: Collector
    undeclare: Callable[[], None]
    strays: Counter[str] = field(default_factory=Counter)
    """By simulator, how many questions went in bundles and were answered alone only, since the last bundled answer."""

    def gets_bundles(self) -> bool:
        """Whether it is worth while to send it bundles."""
        return max(self.strays.values(), default=0) < MOST_STRAYS


@dataclass
class _Simulator:
    """A simulator that this agent asks."""

    asked: Question | None = None
    """What it was asked last."""
    process: _Process | None = None
    """Where that was asked, if it went in a bundle."""
    has_arrived: bool = False
    """Whether an answer shows that this bundle has arrived."""
    take: list[OnBytes] = field(default_factory=list)
    """What takes its answers."""


class AskingSession(ForwardingSession):
    """A session that sends actions for simulators of one process as one message.

    Which simulators have a process in common is told by their liveliness tokens. What is asked again, and what is
    long, is sent alone. `tally` counts the bundles that were refused.
    """

    def __init__(self, session: Session, run: str) -> None:
        super().__init__(session)
        self.tally = Tally()
        self._run = run
        self._lock = threading.Lock()
        self._live: defaultdict[str, set[str]] = defaultdict(set)
        """Live incarnations of the simulators, by name."""
        self._processes: dict[str, _Process] = {}
        self._simulators: defaultdict[str, _Simulator] = defaultdict(_Simulator)
        """By name."""

    def watch_tokens(self, key: str, on_token: OnToken) -> Undeclare:
        """Call `on_token` for each token that lives now, and whenever one comes or goes."""

        def note_and_tell(token: str, alive: bool) -> None:
            self._note_token(token, alive=alive)
            on_token(token, alive)

        return super().watch_tokens(key, note_and_tell)

    def publisher(self, key: str, quality: Quality) -> Sender:
        """Sends bytes under `key`; actions may travel with those for other simulators."""
        alone = super().publisher(key, quality)
        name = keys.simulator_of(key)
        if name is None or key != keys.action(self._run, name):
            return alone

        def send(payload: bytes) -> None:
            process = self._process_to_ask(name, payload)
            if process is None:
                alone.send(payload)
            else:
                process.collector.put(name, Part(key=key, payload=payload))

        return Sender(send, alone.undeclare)

    def subscribe(self, key: str, on_bytes: OnBytes, on_damaged: OnDamaged = ignore) -> Undeclare:
        """Call `on_bytes` for everything that other processes publish under `key`, alone or in a bundle."""
        name = keys.simulator_of(key)
        if name is None or key != keys.observation(self._run, name):
            return super().subscribe(key, on_bytes, on_damaged)

        def take_alone(key: str, payload: bytes) -> None:
            self._note_answer(name, has_arrived=len(payload) > MAX_PART_BYTES)
            on_bytes(key, payload)

        self._simulators[name].take.append(on_bytes)
        undeclare = super().subscribe(key, take_alone, on_damaged)

        def undeclare_both() -> None:
            self._simulators[name].take.remove(on_bytes)
            undeclare()

        return undeclare_both

    def _note_token(self, key: str, *, alive: bool) -> None:
        try:
            token = parse_token(key)
        except MessageError:
            return
        if token.role == "sim" and token.protocol == PROTOCOL_VERSION:
            with self._lock:
                if alive:
                    self._live[token.name].add(token.incarnation)
                else:
                    self._live[token.name].discard(token.incarnation)

    def _process_to_ask(self, name: str, payload: bytes) -> _Process | None:
        """The process that is asked for this simulator in a bundle; None if it is asked alone."""
        question = asked_in(payload)
        with self._lock:
            simulator = self._simulators[name]
            if question is None or question == simulator.asked:
                return None
            last = simulator.process
            if last is not None and not simulator.has_arrived:
                self._note_stray(name, last)
            process = self._process_of(name) if len(payload) <= MAX_PART_BYTES else None
            if last is not None and last is not process:
                last.collector.forget(name)
            simulator.asked, simulator.process, simulator.has_arrived = question, process, False
            return process

    def _process_of(self, name: str) -> _Process | None:
        """The process of this simulator, if it has several simulators and gets bundles."""
        live = self._live[name]
        process = keys.process_of(next(iter(live))) if len(live) == 1 else None
        if process is None:
            return None
        if process not in self._processes:
            self._forget_gone()
            self._processes[process] = self._meet(process)
        found = self._processes[process]
        return found if found.gets_bundles() else None

    def _meet(self, process: str) -> _Process:
        """Begin to talk to a process in bundles."""
        actions = self._session.publisher(keys.bundled_actions(self._run, process), "lockstep")
        undeclare = take_bundles(self._session, keys.bundled_answers(self._run, process), self.tally, self._take_bundle)
        stack = ExitStack()
        stack.callback(actions.undeclare)
        stack.callback(undeclare)
        return _Process(Collector(lambda bundle: actions.send(codec.encode(bundle))), stack.close)

    def _forget_gone(self) -> None:
        """Take back what was declared for processes that have no live simulator."""
        living = {keys.process_of(incarnation) for live in self._live.values() for incarnation in live}
        for process in self._processes.keys() - living:
            self._processes.pop(process).undeclare()

    def _note_stray(self, name: str, process: _Process) -> None:
        """Note a question in a bundle that was answered alone: what was answered is what was asked again."""
        got_bundles = process.gets_bundles()
        process.strays[name] += 1
        if got_bundles and not process.gets_bundles():
            log.warning("sim/%s is asked alone from now on: its process does not get bundles", name)

    def _note_answer(self, name: str, *, has_arrived: bool) -> None:
        """Expect the next action for a simulator that has answered; an answer may show that bundles arrive."""
        with self._lock:
            simulator = self._simulators[name]
            process = simulator.process
            if process is None:
                return
            if has_arrived:
                simulator.has_arrived = True
                process.strays.clear()
            process.collector.expect(name)

    def _take_bundle(self, key: str, bundle: Bundle) -> None:
        for part in bundle.parts:
            name = keys.simulator_of(part.key)
            if name is not None and name in self._simulators and part.key == keys.observation(self._run, name):
                self._note_answer(name, has_arrived=True)
                for on_bytes in tuple(self._simulators[name].take):
                    on_bytes(part.key, part.payload)
