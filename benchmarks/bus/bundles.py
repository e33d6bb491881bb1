"""`python -m benchmarks.bus.bundles`: when it pays to ask the simulators of a process by one message.

One learner steps simulators without physics in the same moment, as the environments of a training, over one link. They
have a link each, or share a process and a link; and then they are asked and answer alone, or in bundles. The three take
turns. The numbers go to `results/bundles.json`.
"""

import sys
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from functools import partial
from time import perf_counter, process_time
from typing import Any, Final, Literal, get_args

import tyro

from agent_proc.statistics.intervals import mean
from benchmarks.bus import payloads
from benchmarks.bus.lockstep import cpu_of
from benchmarks.bus.slow_link import LOOPBACK, Link
from benchmarks.bus.slow_links import LINKS, PATIENCE, PLAIN, proxy, start
from benchmarks.bus.transports import PORTS, RUN
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.bus.bundles.asking import AskingSession
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints
from legpush.bus.session import ZenohSession
from legpush.bus.transport import Session
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.lockstep.server import serve_actions
from legpush.lockstep.sim_host import SimConfig, buses, member_name, serve_each
from legpush.messages.stepping import Motion, Walk
from legpush.soak.stub_simulator import StubSimulator, chained

HOST: Final = "host"
"""First word of the process that this program starts."""
NAME: Final = "host"
Way = Literal["links", "alone", "bundles"]
ALL_LINKS: Final = {"none": PLAIN, **LINKS}
EPISODE_STEPS: Final = 200
WARM_UP_S: Final = 0.5


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    links: tuple[str, ...] = ("none", "far", "far_slow_lossy")
    simulators: tuple[int, ...] = (2, 8, 32)
    seconds: float = 8.0
    """About how long each way is measured, in each repetition."""
    repetitions: int = 3
    name: str = "bundles"
    """Of the file of results."""


def main(config: Config) -> None:
    """Measure and report the numbers."""
    numbers: dict[str, Any] = {"links": {name: asdict(ALL_LINKS[name]) for name in config.links}, "rounds": {}}
    for n in config.simulators:
        for name in config.links:
            rounds: dict[Way, list[float]] = {way: [] for way in get_args(Way)}
            cpu_s = dict.fromkeys(rounds, 0.0)
            for _ in range(config.repetitions):
                for way, taken in rounds.items():
                    more, used_s = measured(way, ALL_LINKS[name], n, config.seconds)
                    taken += more
                    cpu_s[way] += used_s
            found = {way: reported(taken, cpu_s[way], n) for way, taken in rounds.items()}
            numbers["rounds"].setdefault(str(n), {})[name] = found
            print(n, name, found, flush=True)
    write_report(config.name, numbers)


def reported(rounds: list[float], cpu_s: float, n: int) -> dict[str, Any]:
    """Return the mean time of a round, in which each simulator takes a step, and the CPU time of a step."""
    return {
        "n": len(rounds),
        "round_ms": plain(mean([1e3 * each for each in rounds]), 2),
        "cpu_us_per_step": round(1e6 * cpu_s / (len(rounds) * n), 1),
    }


def measured(way: Way, link: Link, n: int, seconds: float) -> tuple[list[float], float]:
    """Return the times of the rounds, and the CPU time of both processes in all of them."""
    with ExitStack() as stack:
        there = stack.enter_context(proxy(link, PORTS["tcp"]))
        own = Endpoints(listen=(f"tcp/{LOOPBACK}:{PORTS['tcp']}",))
        open_session = asking_session if way == "bundles" else None
        bus = stack.enter_context(Bus(RUN, "agent", "main", own, open_session=open_session))
        host = start(stack, "bundles", HOST, way, str(there), str(n))
        stop = threading.Event()
        worlds = [
            BusWorld(SimLink(bus, member_name(NAME, number), stop=stop, patience=PATIENCE))
            for number in range(1, n + 1)
        ]
        bus.announce()
        with ThreadPoolExecutor(n) as threads:
            step_rounds(worlds, threads, WARM_UP_S)
            before_s = cpu_of(host.pid) + process_time()
            rounds = step_rounds(worlds, threads, seconds)
            return rounds, cpu_of(host.pid) + process_time() - before_s


def step_rounds(worlds: Sequence[BusWorld], threads: ThreadPoolExecutor, seconds: float) -> list[float]:
    """Step all worlds in the same moment, again and again; return the time of each round."""
    crc, rounds, until = 0, list[float](), perf_counter() + seconds
    while perf_counter() < until:
        motion: Motion = Walk() if len(rounds) % EPISODE_STEPS else payloads.reset()
        crc = chained(crc, motion)
        began = perf_counter()
        states = list(threads.map(partial(stepped, motion), worlds))
        rounds.append(perf_counter() - began)
        if set(states) != {crc}:
            raise SystemExit(f"Expected state {crc:08x} of all simulators, got {states}")
    return rounds


def stepped(motion: Motion, world: BusWorld) -> int:
    """Step a world; returns its state."""
    return world.step(motion).state_crc


def asking_session(at: Endpoints, who: str) -> Session:
    """Open a session that asks simulators of a process together."""
    return AskingSession(ZenohSession(at, who), RUN)


def host(way: Way, port: int, n: int) -> None:
    """Be some simulators until this process is killed."""
    at, never = Endpoints(connect=(f"tcp/{LOOPBACK}:{port}",)), threading.Event()
    if way != "links":
        with buses(SimConfig(run=RUN, name=NAME, simulators=n), at, never) as members:
            serve_each(members, lambda _: StubSimulator(), never)
    with ExitStack() as stack, ThreadPoolExecutor(n) as threads:
        for number in range(1, n + 1):
            bus = stack.enter_context(Bus(RUN, "sim", member_name(NAME, number), at))
            threads.submit(serve_actions, bus, StubSimulator(), never)
        never.wait()


if __name__ == "__main__":
    if sys.argv[1:2] == [HOST]:
        way: Any = sys.argv[2]
        host(way, int(sys.argv[3]), int(sys.argv[4]))
    else:
        main(tyro.cli(Config))
