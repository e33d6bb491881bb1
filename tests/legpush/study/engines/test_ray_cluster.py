"""A Ray cluster on this machine; clusters of several nodes are in `system/test_study_ray.py`."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import nullcontext
from time import monotonic, sleep

import psutil
import pytest

from legpush.errors import ConfigError, LegpushError
from legpush.study.engines import ray_cluster
from legpush.study.engines.engine import WorkerLostError
from legpush.study.engines.ray_cluster import CLIENT_SERVER_FAILED, Place, RayEngine, read_place
from legpush.study.identity import code_version
from legpush.study.jobs import Job, Task, decode_answer, encode

KIND = "tests.legpush.study.stub:STUB"
N_WORKERS = 2


@pytest.fixture(scope="module")
def engine() -> Iterator[RayEngine]:
    engine = RayEngine("ray", n_workers=N_WORKERS, environment={"OPENBLAS_CORETYPE": "Haswell", "LEGPUSH_TEST": "1"})
    yield engine
    engine.close(now=True)
    left = [" ".join(process.cmdline()) for process in psutil.Process().children(recursive=True)]
    assert [command for command in left if "/ray/" in command or command.startswith("ray::")] == []


def job(*, kind: str = KIND, code: str | None = None, seed: int = 3, kill_at: int = -1) -> bytes:
    """A job of one cell."""
    task = Task(cell="0" * 32, inputs={"seed": seed}, specification={"seed": seed, "kill_at": kill_at})
    code = code_version(KIND) if code is None else code
    return encode(Job(kind=kind, code=code, canary=None, results=None, tasks=(task,)))


@pytest.mark.parametrize(
    ("on", "place"),
    [
        ("ray", Place(None)),
        ("ray:10.0.0.1:6379", Place("10.0.0.1:6379")),
        ("ray:[fd00::1]:6379", Place("[fd00::1]:6379")),
        ("ray://head:10001", Place("head:10001", as_client=True)),
    ],
)
def test_places_of_clusters(on: str, place: Place) -> None:
    assert read_place(on) == place


@pytest.mark.parametrize("on", ["ray:", "ray:head", "ray://", "ray://head", "ray::6379", "ray:head:port", "ray:head:0"])
def test_other_places_are_refused(on: str) -> None:
    with pytest.raises(ConfigError, match=r"Expected ray .* got"):
        read_place(on)


class FakeRay:
    """`ray.init` that fails a number of times, as a client of a cluster: what the server says comes as an error of the
    connection."""

    def __init__(self, n_failures: int, says: str) -> None:
        self.n_failures, self.says, self.n_calls = n_failures, says, 0

    def init(self, **options: object) -> None:
        self.n_calls += 1
        if self.n_calls <= self.n_failures:
            raise ConnectionAbortedError(f"Initialization failure from server:\n{self.says}")


@pytest.mark.parametrize(
    ("n_failures", "says", "n_tries", "n_calls", "is_joined"),
    [
        (2, f"RuntimeError: {CLIENT_SERVER_FAILED[0]}. See ray_client_server_23000.err", 3, 3, True),
        (1, f"{CLIENT_SERVER_FAILED[1]}: PID still exists but it's a zombie (pid=7)", 3, 2, True),
        (1, f"{CLIENT_SERVER_FAILED[2]}: process no longer exists (pid=7)", 3, 2, True),
        (3, f"{CLIENT_SERVER_FAILED[0]}.", 3, 3, False),
        (1, f"{CLIENT_SERVER_FAILED[0]}.", 1, 1, False),
        (1, "the versions of Ray differ", 3, 1, False),
    ],
)
def test_a_client_server_that_could_not_start_a_process_is_asked_again(
    monkeypatch: pytest.MonkeyPatch, n_failures: int, says: str, n_tries: int, n_calls: int, is_joined: bool
) -> None:
    monkeypatch.setattr(ray_cluster, "CLIENT_SERVER_PAUSE_S", 0.0)
    fake = FakeRay(n_failures, says)
    with nullcontext() if is_joined else pytest.raises(ConnectionError):
        ray_cluster._init(fake, {}, n_tries)
    assert fake.n_calls == n_calls


def test_a_job_is_answered_by_a_worker_with_the_environment_that_was_given(engine: RayEngine) -> None:
    answer = decode_answer(engine.submit(job()).result(timeout=60))
    (row,) = answer.rows
    assert (row.columns["value"], answer.refused) == (3.0, None)
    assert answer.pid != os.getpid()
    environment = psutil.Process(answer.pid).environ()
    assert (environment["OPENBLAS_CORETYPE"], environment["LEGPUSH_TEST"]) == ("Haswell", "1")
    assert environment["RAY_AUTH_MODE"] == "token"


def test_there_are_as_many_slots_as_workers(engine: RayEngine) -> None:
    assert engine.n_slots() == N_WORKERS


def test_everything_listens_on_loopback_only(engine: RayEngine) -> None:
    engine.submit(job()).result(timeout=60)
    children = psutil.Process().children(recursive=True)
    listening = {
        connection.laddr.ip
        for process in (psutil.Process(), *children)
        for connection in process.net_connections("tcp")
        if connection.status == psutil.CONN_LISTEN
    }
    assert listening, "nothing listens"
    assert {ip.removeprefix("::ffff:") for ip in listening} == {"127.0.0.1"}


def test_a_worker_that_dies_costs_its_job_only(engine: RayEngine) -> None:
    lost = engine.submit(job(kill_at=3))
    with pytest.raises(WorkerLostError, match="A worker of Ray is gone"):
        lost.result(timeout=60)
    assert decode_answer(engine.submit(job()).result(timeout=60)).rows


def test_an_error_of_a_worker_is_the_error_that_it_raised(engine: RayEngine) -> None:
    with pytest.raises(LegpushError, match="nowhere"):
        engine.submit(job(kind="nowhere")).result(timeout=60)


def test_a_second_cluster_with_other_settings_needs_another_process(
    engine: RayEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAY_AUTH_MODE", "disabled")
    with pytest.raises(ConfigError, match="Ray is not loaded in this process yet, or was loaded with RAY_AUTH_MODE"):
        RayEngine("ray", n_workers=1, environment={})


def test_a_node_that_refuses_gets_no_other_job(engine: RayEngine) -> None:
    refused = decode_answer(engine.submit(job(code="another")).result(timeout=60)).refused
    assert refused is not None
    assert "code version" in refused
    assert engine.n_slots() == 0


HEAD = """
import sys, time
from legpush.study.engines.ray_cluster import RayEngine
engine = RayEngine("ray", n_workers=1, environment={})
print("ready", flush=True)
time.sleep(600)
"""


def test_nothing_is_left_of_a_cluster_whose_head_is_killed() -> None:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    for name in [name for name in environment if name.startswith("RAY_")]:
        del environment[name]
    with subprocess.Popen([sys.executable, "-c", HEAD], stdout=subprocess.PIPE, text=True, env=environment) as head:
        assert head.stdout is not None
        assert head.stdout.readline() == "ready\n"
        # Ray's agents give up only when they have not reached the cluster for a minute.
        children = [
            child
            for child in psutil.Process(head.pid).children(recursive=True)
            if "agent" not in " ".join(child.cmdline()).lower()
        ]
        assert len(children) > 2
        head.kill()
    deadline_s = monotonic() + 30.0
    while any(child.is_running() and child.status() != psutil.STATUS_ZOMBIE for child in children):
        assert monotonic() < deadline_s
        sleep(0.1)
