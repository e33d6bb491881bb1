"""A network in memory, for tests of what stands on a `legpush.bus.transport.Session`."""

from functools import partial
from typing import Any

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.channels import Quality
from legpush.bus.endpoints import Endpoints
from legpush.bus.faults import Faults
from legpush.bus.ports import Subscription
from legpush.bus.transport import OnBytes, OnDamaged, OnToken, Sender, Undeclare, ignore
from legpush.messages.common import Role
from legpush.messages.telemetry import Copies
from legpush.recording.recorder import taken_by

RUN = "test"


def matches(pattern: str, key: str) -> bool:
    """Whether a key is one of those that a pattern names, in which `*` stands for any one segment."""
    wanted, segments = pattern.split("/"), key.split("/")
    return len(wanted) == len(segments) and all(w in ("*", s) for w, s in zip(wanted, segments, strict=True))


class MemoryNetwork:
    """Joins all sessions that are opened on it.

    What is sent has arrived when `send` returns: it is handed over on the sender's thread.
    """

    def __init__(self) -> None:
        self.sessions: list[MemorySession] = []
        self.qualities: dict[str, Quality] = {}
        """By key, how what is sent under it is sent."""

    def open_session(self, endpoints: Endpoints, who: str) -> "MemorySession":
        """Open a session; it does not matter where it listens, and who opens it."""
        del endpoints, who
        session = MemorySession(self)
        self.sessions.append(session)
        return session

    def bus(
        self, role: Role, name: str = "main", run: str = RUN, *, faults: Faults | None = None, recorded: bool = False
    ) -> Bus:
        """A bus on this network."""
        return Bus(run, role, name, Endpoints(), faults, recorded=recorded, open_session=self.open_session)


class MemorySession:
    """A session on a network in memory."""

    def __init__(self, network: MemoryNetwork) -> None:
        self._network = network
        self._subscribers: dict[object, tuple[str, OnBytes]] = {}
        self._watchers: dict[object, tuple[str, OnToken]] = {}
        self._tokens: dict[object, str] = {}

    def close(self) -> None:
        """Leave the network: nothing arrives any more, and all tokens go."""
        self._network.sessions.remove(self)
        for declaration in tuple(self._tokens):
            self._hide_token(declaration)

    def linked(self) -> tuple[str, ...]:
        """No certificates."""
        return ()

    def publisher(self, key: str, quality: Quality) -> Sender:
        """Sends bytes under `key`."""
        self._network.qualities[key] = quality
        return Sender(lambda payload: self.put(key, payload), lambda: None)

    def put(self, key: str, payload: bytes) -> None:
        """Hand bytes to all other sessions that subscribe to their key."""
        for session in tuple(self._network.sessions):
            for pattern, on_bytes in tuple(session._subscribers.values()):
                if session is not self and matches(pattern, key):
                    on_bytes(key, payload)

    def subscribe(self, key: str, on_bytes: OnBytes, on_damaged: OnDamaged = ignore) -> Undeclare:
        """Call `on_bytes` for everything that other sessions publish under `key`, which may hold `*`."""
        declaration = object()
        self._subscribers[declaration] = (key, on_bytes)
        return partial(_remove, self._subscribers, declaration)

    def show_token(self, key: str) -> Undeclare:
        """Show a token until it is taken back or the session is closed."""
        declaration = object()
        self._tokens[declaration] = key
        self._tell(key, alive=True)
        return lambda: self._hide_token(declaration)

    def watch_tokens(self, key: str, on_token: OnToken) -> Undeclare:
        """Call `on_token` for each token that lives now, and whenever one comes or goes."""
        declaration = object()
        self._watchers[declaration] = (key, on_token)
        for session in tuple(self._network.sessions):
            for token in tuple(session._tokens.values()):
                if matches(key, token):
                    on_token(token, True)
        return partial(_remove, self._watchers, declaration)

    def _hide_token(self, declaration: object) -> None:
        key = self._tokens.pop(declaration, None)
        if key is not None:
            self._tell(key, alive=False)

    def _tell(self, token: str, *, alive: bool) -> None:
        for session in tuple(self._network.sessions):
            for pattern, on_token in tuple(session._watchers.values()):
                if matches(pattern, token):
                    on_token(token, alive)


class KeptBatches(Subscription[Copies]):
    """What a recorder is handed; it says to one process, by role and name, that it has everything."""

    def __init__(self, recorder: Bus, role: Role, name: str = "main") -> None:
        channel = channels.copies(recorder.run)
        super().__init__(channel, recorder.tally)
        self.batches: list[Copies] = []
        self._taken = recorder.publisher(channels.taken(recorder.run, role, name))
        recorder.subscribe(channel, self)

    def put(self, message: Copies) -> None:
        """Called on the thread of the process that hands over."""
        self.batches.append(message)
        self._taken.send(taken_by(message))

    def copied(self) -> list[tuple[str, int]]:
        """Key and sequence of everything that was copied."""
        return [(copy.key, copy.sequence) for batch in self.batches for copy in batch.copies]


def _remove(declarations: dict[object, Any], declaration: object) -> None:
    declarations.pop(declaration, None)
