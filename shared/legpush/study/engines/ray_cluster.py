"""Runs jobs on a Ray cluster: one that is started on this machine, or one that runs already."""

import os
import secrets
import sys
from collections.abc import Mapping
from concurrent.futures import Future
from contextlib import ExitStack
from dataclasses import dataclass
from tempfile import TemporaryDirectory
from time import monotonic, sleep
from typing import Any, Final

import msgspec

from legpush.errors import ConfigError
from legpush.study.engines.engine import Pace, WorkerLostError
from legpush.study.engines.ray_token import read_token, require_authentication

PREFIX: Final = "ray"
"""How `--on` begins."""
ANYWHERE: Final = {"RAY_AUTH_MODE": "token", "RAY_USAGE_STATS_ENABLED": "0"}
"""What Ray reads from the environment when it is loaded, for every cluster."""
ON_LOOPBACK: Final = {"RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0"}
"""Keeps Ray on the loopback interface. Without it Ray replaces 127.0.0.1 by an address that other machines reach, and
listens on all interfaces."""
OBJECT_STORE_BYTES: Final = 100 * 2**20
"""Room for jobs and answers on this machine; Ray takes a third of the memory by itself."""
LOOPBACK: Final = "127.0.0.1"
CLIENT_SERVER_FAILED: Final = ("Starting Ray client server failed", "psutil.ZombieProcess", "psutil.NoSuchProcess")
"""What Ray says when the process of a client ended while it was started. It looks at its command line meanwhile."""
CLIENT_SERVER_TRIES: Final = 3
CLIENT_SERVER_PAUSE_S: Final = 2.0
"""A client server starts a process for each client. On a busy machine that process can end before it answers."""
COUNT_S: Final = 1.0
"""The CPUs of the cluster are counted this often at most."""


class _Refusal(msgspec.Struct):
    """The part of an answer that says whether the worker ran the job."""

    refused: str | None = None


_REFUSALS: Final = msgspec.msgpack.Decoder(_Refusal)


@dataclass(frozen=True)
class Place:
    """Where a Ray cluster is."""

    address: str | None
    """`host:port` of its head or of its client server; None starts a cluster on this machine."""
    as_client: bool = False
    """Whether the address is that of its client server, for machines that are no node of the cluster."""


def read_place(on: str) -> Place:
    """Return what `ray`, `ray:HOST:PORT` or `ray://HOST:PORT` means.

    Raises:
        ConfigError: It is none of these.
    """
    if on == PREFIX:
        return Place(None)
    as_client = on.startswith("ray://")
    address = on.removeprefix("ray://" if as_client else "ray:")
    host, colon, port = address.rpartition(":")
    if on == address or not (host and colon and port.isdecimal() and 0 < int(port) < 2**16):
        raise ConfigError(
            f"Expected ray (a cluster on this machine), ray:HOST:PORT (the head of a cluster of which this machine is "
            f"a node) or ray://HOST:PORT (its client server), got {on!r}"
        )
    return Place(address, as_client)


class RayEngine:
    """Jobs as tasks of a Ray cluster; Ray decides where each one runs.

    A node whose worker refuses a job gets no other one.
    """

    name = PREFIX
    pace = Pace()
    workers_keep_rows = False

    def __init__(self, on: str, *, n_workers: int, environment: Mapping[str, str]) -> None:
        """Start or join the cluster.

        Args:
            on: `ray`, `ray:HOST:PORT` or `ray://HOST:PORT`.
            n_workers: Number of worker processes of a cluster on this machine; another one has its own number.
            environment: Environment variables of the workers.

        Raises:
            ConfigError: Ray is not installed or was loaded with other settings, or the cluster cannot be joined, asks
                for no token, or has another one.
        """
        place = read_place(on)
        with ExitStack() as stack:
            self._ray = _load(place)
            _connect(self._ray, place, n_workers, environment, stack)
            self._closing = stack.pop_all()
        # Losses are counted for each cell by the head of a study, on all engines in the same way.
        self._work = self._ray.remote(num_cpus=1, max_retries=0)(_work_on_node)
        self._refused_nodes: set[str] = set()
        self._references: dict[Future[bytes], Any] = {}
        self._n_slots, self._counted_s = 0, float("-inf")

    def n_slots(self) -> int:
        """Return the number of CPUs of the nodes that are alive and were not refused, not older than `COUNT_S`."""
        if monotonic() - self._counted_s >= COUNT_S:
            self._n_slots, self._counted_s = self._count(), monotonic()
        return self._n_slots

    def _count(self) -> int:
        nodes = (node for node in self._ray.nodes() if node["Alive"] and node["NodeID"] not in self._refused_nodes)
        return sum(int(node["Resources"].get("CPU", 0)) for node in nodes)

    def submit(self, job: bytes) -> "Future[bytes]":
        """Queue a job; see `Engine`."""
        answer: Future[bytes] = Future()
        elsewhere = ",".join(sorted(self._refused_nodes))
        selector = {"ray.io/node-id": f"!in({elsewhere})"} if elsewhere else {}
        reference = self._work.options(label_selector=selector).remote(job)
        self._references[answer] = reference
        reference.future().add_done_callback(lambda done: self._take(answer, done))
        return answer

    def close(self, *, now: bool) -> None:
        """Leave the cluster, and end it if it was started here; `now` gives up the jobs that are queued."""
        references = tuple(self._references.values())
        if now:
            for reference in references:
                self._ray.cancel(reference, force=True)
        elif references:
            self._ray.wait(list(references), num_returns=len(references))
        self._closing.close()

    def _take(self, answer: "Future[bytes]", done: "Future[tuple[str, bytes]]") -> None:
        """Pass on what a task returned or raised."""
        self._references.pop(answer, None)
        error = done.exception()
        if error is None:
            node, payload = done.result()
            if _REFUSALS.decode(payload).refused is not None:
                self._refused_nodes.add(node)
                self._counted_s = float("-inf")
            answer.set_result(payload)
        else:
            answer.set_exception(self._meaning(error))

    def _meaning(self, error: BaseException) -> BaseException:
        """Return what an exception of Ray means to the head of a study."""
        errors = self._ray.exceptions
        lost = (
            errors.WorkerCrashedError,
            errors.NodeDiedError,
            errors.OutOfMemoryError,
            errors.ObjectLostError,
            errors.TaskCancelledError,
            errors.RaySystemError,
        )
        if isinstance(error, lost):
            return WorkerLostError(f"A worker of Ray is gone ({type(error).__name__}: {_first_line(error)})")
        if isinstance(error, errors.RayTaskError) and isinstance(error.cause, BaseException):
            return error.cause
        return error


def _work_on_node(job: bytes) -> tuple[str, bytes]:
    """Run a job in a worker; return the node and the answer."""
    import ray

    from legpush.study.work import work

    return ray.get_runtime_context().get_node_id(), work(job)


def _load(place: Place) -> Any:
    """Check the cluster, set what Ray reads when it is loaded, and load it."""
    if place.address is None:
        # A token of its own for each cluster on this machine, which only its processes know.
        token = os.environ.get("RAY_AUTH_TOKEN") or secrets.token_hex(32)
        settings = {**ANYWHERE, **ON_LOOPBACK, "RAY_AUTH_TOKEN": token}
    else:
        require_authentication("client server" if place.as_client else "head", place.address, read_token())
        settings = dict(ANYWHERE)
    is_loaded = sys.modules.get("ray") is not None
    if is_loaded and (stale := [name for name, value in settings.items() if os.environ.get(name) != value]):
        raise ConfigError(
            f"Expected that Ray is not loaded in this process yet, or was loaded with {', '.join(stale)} set for this "
            "cluster; start the study in a process of its own"
        )
    os.environ.update(settings)
    import ray

    return ray


def _connect(ray: Any, place: Place, n_workers: int, environment: Mapping[str, str], stack: ExitStack) -> None:
    """Start or join a cluster; what is to be done at the end goes on the stack."""
    options: dict[str, Any] = {
        "runtime_env": {"env_vars": dict(environment)},
        "log_to_driver": False,
        "logging_level": "ERROR",
    }
    if place.address is None:
        # Ray's own folder can be read by every user of this machine, and has sockets in it.
        folder = stack.enter_context(TemporaryDirectory(prefix="legpush-ray-", ignore_cleanup_errors=True))
        options |= {
            "address": "local",
            "num_cpus": n_workers,
            "include_dashboard": False,
            "object_store_memory": OBJECT_STORE_BYTES,
            "_temp_dir": folder,
        }
    else:
        options["address"] = f"ray://{place.address}" if place.as_client else place.address
    try:
        _init(ray, options, n_tries=CLIENT_SERVER_TRIES if place.as_client else 1)
    except (ConnectionError, RuntimeError, ValueError, ray.exceptions.RayError) as error:
        where = f"at {place.address}" if place.address else "on this machine"
        raise ConfigError(f"The Ray cluster {where} cannot be used: {_last_line(error)}") from error
    stack.callback(ray.shutdown)
    if place.address is None and (address := ray.get_runtime_context().gcs_address) and not _is_loopback(address):
        raise ConfigError(f"Expected a Ray cluster on {LOOPBACK}, got one at {address}")


def _init(ray: Any, options: Mapping[str, Any], n_tries: int) -> None:
    """Call `ray.init`, and again where a client server could not start a process for this client."""
    for n in range(1, n_tries + 1):
        try:
            ray.init(**options)
        except (ConnectionError, RuntimeError) as error:
            if n == n_tries or not any(said in str(error) for said in CLIENT_SERVER_FAILED):
                raise
            sleep(CLIENT_SERVER_PAUSE_S)
        else:
            return


def _is_loopback(address: str) -> bool:
    return address.rpartition(":")[0] == LOOPBACK


def _first_line(error: BaseException) -> str:
    return str(error).strip().partition("\n")[0]


def _last_line(error: BaseException) -> str:
    return str(error).strip().rpartition("\n")[2]
