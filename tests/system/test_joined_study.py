"""A study whose workers are on the bus, through a router and over TLS: they come late, are killed, and are replaced."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pyarrow.parquet as parquet
import pytest

from tests.legpush.fakes import eventually
from tests.legpush.study.parts import STUB
from tests.ports import free_ports
from tests.security.hosts import made
from tests.system.commands import LEGPUSH
from tests.system.missions import LIMIT_S

ROOT = Path(__file__).parents[2]
CELLS = """
name = "joined"

[settings]
factor = 3.0
seconds = 0.1

[axes]
seed = { first = 0, n = 60 }
"""


class Lab:
    """A router over TLS, and processes that end with the test."""

    def __init__(self, stack: ExitStack, folder: Path) -> None:
        self._stack, self._folder = stack, folder
        self._lab = made(folder / "lab", "hub=127.0.0.1", "robot=127.0.0.1", routers=("hub",)).parent
        self._at = f"tls/127.0.0.1:{free_ports(1)[0]}"
        self.start("router", "router", "--listen", self._at, "--secure", str(self._lab / "hub"))
        assert eventually(lambda: "routing, listening" in self.said("router"), LIMIT_S), self.said("router")

    def start(self, name: str, *words: str) -> "subprocess.Popen[bytes]":
        """Start a command of legpush."""
        return self._start(name, [str(LEGPUSH), *words])

    def start_python(self, name: str, module: str, *words: str) -> "subprocess.Popen[bytes]":
        """Start a process by hand."""
        return self._start(name, [sys.executable, "-P", "-m", module, *words])

    def _start(self, name: str, words: list[str]) -> "subprocess.Popen[bytes]":
        with (self._folder / f"{name}.log").open("wb") as log:
            process = subprocess.Popen(words, cwd=ROOT, stdout=log, stderr=subprocess.STDOUT)
        self._stack.callback(process.wait)
        self._stack.callback(process.kill)
        return process

    def by_router(self, host: str) -> tuple[str, ...]:
        """The options of a client of the router."""
        return "--router", self._at, "--secure", str(self._lab / host)

    def worker(self, name: str) -> "subprocess.Popen[bytes]":
        """Start a worker."""
        words = ("study", "work", "--run", "joined", "--name", name, "--workers", "1", "--cell", STUB)
        return self.start(name, *words, *self.by_router("robot"))

    def said(self, name: str) -> str:
        """What a process has written."""
        return (self._folder / f"{name}.log").read_text()


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Lab]:
    """A router, and nobody else."""
    monkeypatch.setenv("PYTHONPATH", f"{ROOT}:{ROOT / 'shared'}")
    (tmp_path / "study.toml").write_text(CELLS)
    with ExitStack() as stack:
        yield Lab(stack, tmp_path)


def values(folder: Path) -> list[tuple[int, float]]:
    """Seed and result of each cell."""
    rows = parquet.read_table(folder / "cells.parquet").to_pylist()
    return [(row["seed"], row["value"]) for row in rows]


def test_a_study_is_done_to_the_end_though_workers_are_killed_and_replaced(lab: Lab, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ("study", "run", str(tmp_path / "study.toml"), "--out", str(out), "--cell", STUB, "--join", "joined")
    head = lab.start("head", *words, *lab.by_router("hub"))
    lost = lab.worker("a")
    lab.worker("b")
    assert eventually(lambda: "a works for" in lab.said("a"), LIMIT_S), lab.said("a")
    lost.kill()
    lab.worker("c")

    assert head.wait(LIMIT_S) == 0, lab.said("head")
    assert values(out) == [(seed, 3.0 * seed) for seed in range(60)]
    assert "worker/a is" in lab.said("head")
    assert "cells are sent again" in lab.said("head")


@pytest.mark.parametrize("of", ["a worker", "simulators"])
def test_who_shares_a_session_is_told_that_its_certificate_is_refused(lab: Lab, tmp_path: Path, of: str) -> None:
    """A host of another authority: its processes would else wait for a router that does not take them."""
    made(tmp_path / "other", "robot=127.0.0.1")
    (tmp_path / "lab" / "robot").rename(tmp_path / "kept")
    (tmp_path / "other" / "robot").rename(tmp_path / "lab" / "robot")
    if of == "a worker":
        stranger = lab.worker("stranger")
    else:
        stranger = lab.start_python("stranger", "sim_proc", "--simulators", "2", *lab.by_router("robot"))
    assert stranger.wait(LIMIT_S) == 2, lab.said("stranger")
    assert "error: " in lab.said("stranger")
    assert "Traceback" not in lab.said("stranger")


def test_a_certificate_of_another_role_does_not_work_for_a_study(lab: Lab, tmp_path: Path) -> None:
    """A host whose folder has the certificate of a viewer in the place of that of a worker."""
    robot = tmp_path / "lab" / "robot"
    for end in ("pem", "key"):
        (robot / f"worker.{end}").write_bytes((robot / f"viewer.{end}").read_bytes())
    stranger = lab.worker("stranger")
    assert stranger.wait(LIMIT_S) == 2, lab.said("stranger")
    assert "Traceback" not in lab.said("stranger")
