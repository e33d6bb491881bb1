"""The agent's end of bundles: simulators of one process are asked together."""

import logging
import threading
from collections import defaultdict
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Final

from legpush.bus import keys
from legpush.bus.bundles.collector import MAX_PART_BYTES, Collector
from legpush.bus.bundles.forwarding import ForwardingSession
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
"""A process that answers as many bundles alone, one after the other, has not got them: what it answers is what was
asked again.
"""


@dataclass
class _Process:
    """A process with several simulators."""

    collector: Collector
    undeclare: Callable[[], None]
    n_strays: int = 0
    """How many answers to bundles came alone since the last bundle of answers."""


@dataclass
class _Simulator:
    """A simulator that this agent asks."""

    waits: bool = False
    """Whether it was asked and has not answered."""
    process: _Process | None = None
    """Where it was asked last, if that was in a bundle."""
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
            process = self._process_to_ask(name, len(payload))
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
            self._note_answer(name, stray=len(payload) <= MAX_PART_BYTES)
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

    def _process_to_ask(self, name: str, n_bytes: int) -> _Process | None:
        """The process that is asked for this simulator in a bundle; None if it is asked alone."""
        with self._lock:
            simulator = self._simulators[name]
            if simulator.waits:
                return None
            simulator.waits, simulator.process = True, None
            live = self._live[name]
            if n_bytes > MAX_PART_BYTES or len(live) != 1:
                return None
            process = keys.process_of(next(iter(live)))
            if process is None:
                return None
            if process not in self._processes:
                self._forget_gone()
                self._processes[process] = self._meet(process)
            found = self._processes[process]
            if found.n_strays >= MOST_STRAYS:
                return None
            simulator.process = found
            return found

    def _meet(self, process: str) -> _Process:
        """Begin to talk to a process in bundles."""
        actions = self._session.publisher(keys.bundled_actions(self._run, process), "lockstep")
        undeclare = self._session.subscribe(
            keys.bundled_answers(self._run, process), self._take_bundle, self._refuse_damaged
        )
        stack = ExitStack()
        stack.callback(actions.undeclare)
        stack.callback(undeclare)
        return _Process(Collector(lambda bundle: actions.send(codec.encode(bundle))), stack.close)

    def _forget_gone(self) -> None:
        """Take back what was declared for processes that have no live simulator."""
        living = {keys.process_of(incarnation) for live in self._live.values() for incarnation in live}
        for process in self._processes.keys() - living:
            self._processes.pop(process).undeclare()

    def _note_answer(self, name: str, *, stray: bool) -> None:
        """Expect the next action for a simulator that has answered."""
        with self._lock:
            simulator = self._simulators[name]
            simulator.waits = False
            process = simulator.process
            if process is None:
                return
            process.n_strays = process.n_strays + 1 if stray else 0
            process.collector.expect(name)
            if process.n_strays == MOST_STRAYS:
                log.warning("sim/%s is asked alone from now on: its process does not get bundles", name)

    def _take_bundle(self, key: str, payload: bytes) -> None:
        try:
            bundle = codec.decode(payload, Bundle)
        except MessageError as error:
            self.tally.add(error.cause, f"{key}: {error}")
            return
        for part in bundle.parts:
            name = keys.simulator_of(part.key)
            if name is not None and name in self._simulators and part.key == keys.observation(self._run, name):
                self._note_answer(name, stray=False)
                for on_bytes in tuple(self._simulators[name].take):
                    on_bytes(part.key, part.payload)

    def _refuse_damaged(self, key: str) -> None:
        self.tally.add("damaged", f"{key}: expected the bytes that were sent, got others by the checksum")
