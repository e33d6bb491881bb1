"""`python -m benchmarks.bus.slow_links`: steps of the lockstep over links with delay, rate and loss, beside a model.

A simulator without physics answers with about as many bytes as asked for. First its steps are timed over the same proxy
without delay and loss, with pauses as long as the delay of a round trip between them: that is the time of both
processes, which wake up for each step. The model adds what the link adds. The numbers go to `results/slow_links.json`.
"""

import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, sleep
from typing import Any, Final

import tyro

from agent_proc.statistics.intervals import mean
from benchmarks.bus import payloads
from benchmarks.bus.slow_link import LOOPBACK, Link
from benchmarks.bus.transports import PORTS, RUN
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.messages.stepping import Walk
from legpush.patience import Patience

LINKS: Final = {
    "far": Link(delay_ms=20.0),
    "far_slow": Link(delay_ms=20.0, mbit_s=10.0),
    "far_slow_lossy": Link(delay_ms=20.0, mbit_s=10.0, loss=0.01),
}
PLAIN: Final = Link()
OVERHEAD_BYTES: Final = 130
"""About what Zenoh and TCP put around a message: headers, a checksum and lengths."""
PAUSE_S: Final = 0.04
PATIENCE: Final = Patience(deadline_s=60.0, resend_s=5.0)


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    links: tuple[str, ...] = tuple(LINKS)
    sizes: tuple[int, ...] = (1_000, 10_000, 100_000)
    """Bytes of the answers, about; the question is a `Walk`."""
    seconds: float = 45.0
    """About how long the steps over one link take."""
    name: str = "slow_links"
    """Of the file of results."""


def main(config: Config) -> None:
    """Measure and report the numbers."""
    numbers: dict[str, Any] = {"links": {name: asdict(LINKS[name]) for name in config.links}, "sizes": {}}
    for n_bytes in config.sizes:
        own_s = steps(PLAIN, n_bytes, n=200, pause_s=PAUSE_S)
        both_s = sum(own_s) / len(own_s)
        sizes = len(payloads.question()) + OVERHEAD_BYTES, len(payloads.answer(n_bytes)) + OVERHEAD_BYTES
        found: dict[str, Any] = {"n_bytes": sizes[1], "own_ms": plain(mean([1e3 * each for each in own_s]), 2)}
        for name in config.links:
            predicted_s = predicted(LINKS[name], sizes, both_s)
            measured_s = steps(LINKS[name], n_bytes, n=max(30, round(config.seconds / predicted_s)))
            found[name] = reported(measured_s, predicted_s)
            print(n_bytes, name, found[name])
        numbers["sizes"][str(n_bytes)] = found
    write_report(config.name, numbers)


def predicted(link: Link, sizes: Sequence[int], own_s: float) -> float:
    """Return the expected time of a step with messages of these sizes, where both processes take `own_s` of it."""
    return own_s + sum(link.message_s(n_bytes) for n_bytes in sizes)


def reported(measured_s: Sequence[float], predicted_s: float) -> dict[str, Any]:
    """Return steps per second, measured and predicted, their ratio, and the mean time of a step with its interval."""
    each = mean(measured_s)
    return {
        "n": len(measured_s),
        "step_ms": plain(mean([1e3 * value for value in measured_s]), 1),
        "predicted_step_ms": round(1e3 * predicted_s, 1),
        "steps_per_s": round(1.0 / each.value, 2),
        "predicted_steps_per_s": round(1.0 / predicted_s, 2),
        "over_predicted": round(predicted_s / each.value, 3),
    }


def steps(link: Link, n_bytes: int, n: int, pause_s: float = 0.0) -> list[float]:
    """Return how long each of `n` steps took, with a pause before each."""
    taken = []
    with linked(link, n_bytes) as world:
        for _ in range(n):
            sleep(pause_s)
            began = perf_counter()
            world.step(Walk())
            taken.append(perf_counter() - began)
    return taken


@contextmanager
def linked(link: Link, n_bytes: int) -> Iterator[BusWorld]:
    """A simulator at the other end of a link, in an episode."""
    with ExitStack() as stack:
        scratch = stack.enter_context(TemporaryDirectory(prefix="legpush-bench-"))
        start(stack, "transports", "legpush tcp", scratch, str(n_bytes))
        at = stack.enter_context(proxy(link, PORTS["tcp"]))
        bus = stack.enter_context(Bus(RUN, "agent", "main", Endpoints(connect=(f"tcp/{LOOPBACK}:{at}",))))
        world = BusWorld(SimLink(bus, "main", stop=threading.Event(), patience=PATIENCE))
        bus.announce()
        world.step(payloads.reset())
        yield world


@contextmanager
def proxy(link: Link, to_port: int) -> Iterator[int]:
    """Start a link to a port of this machine; gives the port at its other end."""
    from_port = PORTS["tcp"] + 10
    with ExitStack() as stack:
        settings = [word for name, value in asdict(link).items() for word in (f"--link.{name}", str(value))]
        process = start(stack, "slow_link", str(from_port), str(to_port), *settings)
        assert process.stdout is not None
        process.stdout.readline()
        yield from_port


def start(stack: ExitStack, module: str, *words: str) -> "subprocess.Popen[bytes]":
    """Start a module of this folder, which ends with the stack."""
    argv = [sys.executable, "-m", f"benchmarks.bus.{module}", *words]
    process = subprocess.Popen(argv, cwd=Path(__file__).parents[2], stdout=subprocess.PIPE)
    stack.callback(process.communicate)
    stack.callback(process.kill)
    return process


if __name__ == "__main__":
    main(tyro.cli(Config))
