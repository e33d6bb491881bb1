"""A learner and processes of several simulators on a network in memory that counts bundles."""

import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from time import monotonic, sleep

import msgspec

from legpush.bus.bundles.asking import AskingSession
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.lockstep.sim_host import SimConfig, buses, serve_each
from legpush.patience import Patience
from legpush.soak.stub_simulator import StubSimulator
from tests.legpush.bus.memory_session import RUN, MemoryNetwork, MemorySession
from tests.legpush.fakes import eventually

IMPATIENT = Patience(deadline_s=20.0, resend_s=0.1)


@dataclass
class Network(MemoryNetwork):
    """A network that counts the messages under each key, may lose bundles, and may be slow."""

    put: list[tuple[str, bytes]] = field(default_factory=list)
    loses_bundles: bool = False
    delay_s: float = 0.0
    """Each way."""

    def __post_init__(self) -> None:
        super().__init__()
        self.postman = ThreadPoolExecutor(1)
        """Delivers what is delayed, in order."""

    def open_session(self, endpoints: Endpoints, who: str) -> MemorySession:
        """Open a session."""
        session = _Counting(self)
        self.sessions.append(session)
        return session

    def bundles(self, what: str) -> list[bytes]:
        """Bundles of `action` or `observation` that were sent."""
        return [payload for key, payload in self.put if "/bundle/" in key and key.endswith(f"/{what}")]

    def shows(self, incarnation: str) -> bool:
        """Whether a process with this incarnation shows its token."""
        return any(token.endswith(f"/{incarnation}") for session in self.sessions for token in session._tokens.values())

    def alone(self, what: str) -> list[str]:
        """Keys of actions or observations that were sent alone."""
        return [key for key, _ in self.put if "/sim/" in key and key.endswith(f"/{what}") and "/tap/" not in key]


class _Counting(MemorySession):
    def __init__(self, network: Network) -> None:
        super().__init__(network)
        self._counts = network

    def put(self, key: str, payload: bytes) -> None:
        self._counts.put.append((key, payload))
        if self._counts.loses_bundles and "/bundle/" in key:
            return
        if self._counts.delay_s > 0.0:
            self._counts.postman.submit(self._put_at, monotonic() + self._counts.delay_s, key, payload)
        else:
            super().put(key, payload)

    def _put_at(self, due: float, key: str, payload: bytes) -> None:
        sleep(max(due - monotonic(), 0.0))
        super().put(key, payload)


def question(step: int, agent: str = "a") -> bytes:
    """What matters of an action."""
    return msgspec.msgpack.encode({"header": {"incarnation": agent}, "episode": 1, "step": step})


def answer(step: int, agent: str = "a", n_bytes: int = 0) -> bytes:
    """What matters of an answer, and more bytes."""
    return msgspec.msgpack.encode({"agent_incarnation": agent, "episode": 1, "step": step, "more": b"x" * n_bytes})


@contextmanager
def simulators(network: Network, name: str, n: int) -> Iterator[list[Bus]]:
    """A process of `n` simulators."""
    stop = threading.Event()
    config = SimConfig(run=RUN, name=name, simulators=n)
    with buses(config, Endpoints(), stop, network.open_session) as members:
        served = threading.Thread(target=serve_each, args=(members, lambda _: StubSimulator(), stop))
        served.start()
        try:
            assert eventually(lambda: all(network.shows(bus.incarnation) for bus in members))
            yield members
        finally:
            stop.set()
            served.join(20.0)


@contextmanager
def learner(network: Network) -> Iterator[tuple[Bus, AskingSession]]:
    """A learner that asks in bundles."""
    opened: list[AskingSession] = []

    def open_session(at: Endpoints, who: str) -> AskingSession:
        opened.append(AskingSession(network.open_session(at, who), RUN))
        return opened[0]

    with Bus(RUN, "agent", "main", Endpoints(), open_session=open_session) as bus:
        bus.announce()
        yield bus, opened[0]


@contextmanager
def worlds(bus: Bus, *names: str) -> Iterator[list[BusWorld]]:
    """Worlds of these simulators."""
    with ExitStack() as stack:
        stop = threading.Event()
        stack.callback(stop.set)
        yield [BusWorld(SimLink(bus, name, stop=stop, patience=IMPATIENT)) for name in names]
