"""Both ends of a round trip on each transport: legpush's lockstep, Zenoh alone, ZeroMQ, gRPC and a pipe.

All of them use sockets of this machine. Alone, a transport carries bytes that nobody reads; legpush makes a message of
its records, checks it and sends it exactly once. `python -m benchmarks.bus.transports NAME FOLDER N_BYTES` is the end
that answers.
"""

import queue
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Client, Connection, Listener
from pathlib import Path
from typing import Any, Final

from benchmarks.bus import payloads
from legpush.bus.bus import Bus
from legpush.bus.channels import Quality
from legpush.bus.endpoints import Endpoints, by_router, in_directory
from legpush.bus.secure.host_folder import read_credentials
from legpush.bus.session import ZenohSession
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.lockstep.server import serve_actions
from legpush.messages.common import Role
from legpush.messages.stepping import Walk

RUN: Final = "bench"
LOCKSTEP: Final[Quality] = "lockstep"
PORTS: Final = {"tcp": 17881, "tls": 17882}
ROUTED: Final = ("legpush router", "zenoh router")
"""Both ends of these are clients of a router."""
GRPC_METHOD: Final = "/bench/step"

Ask = Callable[[], int]
"""Asks once, waits for the answer, and returns its size; 0 if it is a record by then."""


def router_at(folder: Path) -> str:
    """Return the endpoint of the router."""
    return f"unixsock-stream/{folder}/router.sock"


def endpoints(name: str, folder: Path, role: Role) -> Endpoints:
    """Return where the two ends of legpush's or Zenoh's transport meet."""
    if name in ROUTED:
        return by_router((router_at(folder),))
    if name in ("legpush", "zenoh"):
        own = in_directory(folder, "sim").listen
        return Endpoints(listen=own) if role == "sim" else Endpoints(connect=own)
    protocol = name.removeprefix("legpush ")
    at = (f"{protocol}/127.0.0.1:{PORTS[protocol]}",)
    credentials = read_credentials(folder / "host", role) if protocol == "tls" else None
    return Endpoints(listen=at if role == "sim" else (), connect=at if role == "agent" else (), credentials=credentials)


@contextmanager
def ask_legpush(name: str, folder: Path) -> Iterator[Ask]:
    """The lockstep."""
    with Bus(RUN, "agent", "main", endpoints(name, folder, "agent")) as bus:
        world = BusWorld(SimLink(bus, "main", stop=threading.Event()))
        bus.announce()
        world.step(payloads.reset())

        def ask() -> int:
            world.step(Walk())
            return 0

        yield ask


def answer_legpush(name: str, folder: Path, n_bytes: int) -> None:
    """Answer as a simulator does."""
    with Bus(RUN, "sim", "main", endpoints(name, folder, "sim")) as bus:
        serve_actions(bus, payloads.SizedSimulator(n_bytes), threading.Event())


class ZenohEnd:
    """One end of Zenoh alone, with the settings of legpush's session: its publisher, its callback, a queue."""

    def __init__(self, name: str, folder: Path, role: Role) -> None:
        session: Any = ZenohSession(endpoints(name, folder, role), role)
        said, heard = ("answer", "question") if role == "sim" else ("question", "answer")
        self._inbox: queue.Queue[bytes] = queue.Queue()
        self._publisher = session.declare_publisher(f"bench/{said}", LOCKSTEP)
        self._undeclare = session.declare_subscriber(
            f"bench/{heard}", lambda sample: self._inbox.put(sample.payload.to_bytes())
        )
        self.close: Callable[[], None] = session.close

    def put(self, payload: bytes) -> None:
        """Send."""
        self._publisher.put(payload)

    def get(self, timeout_s: float | None = None) -> bytes:
        """Wait for what comes next."""
        return self._inbox.get(timeout=timeout_s)


@contextmanager
def ask_zenoh(name: str, folder: Path) -> Iterator[Ask]:
    """Zenoh alone."""
    end, question = ZenohEnd(name, folder, "agent"), payloads.question()

    def ask() -> int:
        end.put(question)
        return len(end.get())

    while True:  # Until the subscriber at the other end is known, what is published goes nowhere.
        try:
            end.put(question)
            end.get(0.2)
            break
        except queue.Empty:
            continue
    yield ask
    end.close()


def answer_zenoh(name: str, folder: Path, n_bytes: int) -> None:
    """Answer with bytes."""
    end, payload = ZenohEnd(name, folder, "sim"), payloads.answer(n_bytes)
    while True:
        end.get()
        end.put(payload)


@contextmanager
def ask_zeromq(name: str, folder: Path) -> Iterator[Ask]:
    """ZeroMQ's REQ and REP."""
    del name
    import zmq

    question = payloads.question()
    with zmq.Context() as context, context.socket(zmq.REQ) as socket:
        socket.connect(f"ipc://{folder}/zeromq")

        def ask() -> int:
            socket.send(question)
            return len(socket.recv())

        yield ask


def answer_zeromq(name: str, folder: Path, n_bytes: int) -> None:
    """Answer with bytes."""
    del name
    import zmq

    payload = payloads.answer(n_bytes)
    with zmq.Context() as context, context.socket(zmq.REP) as socket:
        socket.bind(f"ipc://{folder}/zeromq")
        while True:
            socket.recv()
            socket.send(payload)


@contextmanager
def ask_grpc(name: str, folder: Path) -> Iterator[Ask]:
    """One call of gRPC, of bytes."""
    del name
    import grpc

    question = payloads.question()
    with grpc.insecure_channel(f"unix:{folder}/grpc") as channel:
        call = channel.unary_unary(GRPC_METHOD)

        def ask() -> int:
            return len(call(question, wait_for_ready=True))

        yield ask


def answer_grpc(name: str, folder: Path, n_bytes: int) -> None:
    """Answer with bytes."""
    del name
    from concurrent.futures import ThreadPoolExecutor

    import grpc

    payload = payloads.answer(n_bytes)

    class Handler(grpc.GenericRpcHandler):  # type: ignore[misc]
        """Answers every call."""

        def service(self, details: Any) -> Any:
            """Return what answers a call."""
            del details
            return grpc.unary_unary_rpc_method_handler(lambda request, context: payload)

    server = grpc.server(ThreadPoolExecutor(1), handlers=(Handler(),))
    server.add_insecure_port(f"unix:{folder}/grpc")
    server.start()
    server.wait_for_termination()


@contextmanager
def ask_pipe(name: str, folder: Path) -> Iterator[Ask]:
    """A connection of `multiprocessing`, over a socket: the least that two processes need."""
    del name
    question = payloads.question()
    with _connected(str(folder / "pipe")) as connection:

        def ask() -> int:
            connection.send_bytes(question)
            return len(connection.recv_bytes())

        yield ask


def _connected(address: str) -> "Connection[Any, Any]":
    """Connect as soon as somebody listens: the socket is there a moment before."""
    while True:
        try:
            return Client(address, "AF_UNIX")
        except (FileNotFoundError, ConnectionRefusedError):
            threading.Event().wait(0.01)


def answer_pipe(name: str, folder: Path, n_bytes: int) -> None:
    """Answer with bytes."""
    del name
    payload = payloads.answer(n_bytes)
    with (
        Listener(str(folder / "pipe"), "AF_UNIX") as listener,
        listener.accept() as connection,
        suppress(EOFError),
    ):
        while True:
            connection.recv_bytes()
            connection.send_bytes(payload)


TRANSPORTS: Final = {
    "legpush": (ask_legpush, answer_legpush, None),
    "legpush tcp": (ask_legpush, answer_legpush, None),
    "legpush tls": (ask_legpush, answer_legpush, None),
    "legpush router": (ask_legpush, answer_legpush, None),
    "zenoh": (ask_zenoh, answer_zenoh, None),
    "zenoh router": (ask_zenoh, answer_zenoh, None),
    "zeromq": (ask_zeromq, answer_zeromq, "zmq"),
    "grpc": (ask_grpc, answer_grpc, "grpc"),
    "pipe": (ask_pipe, answer_pipe, None),
}
"""Of each transport its two ends, and the library that has to be installed."""


if __name__ == "__main__":
    TRANSPORTS[sys.argv[1]][1](sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]))
