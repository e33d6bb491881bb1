"""`python -m benchmarks.bus.many_simulators`: one learner steps 200 simulators without physics, behind two routers.

The simulators live in 20 processes, half of them at each router. The learner is a client of the first router. It steps
them in one of three ways:

- `in_turn`: each simulator has a session and a link of its own, and those of a process are stepped one after the other;
- `alone`: the same, but those of a process are stepped in the same moment, as the environments of a training are;
- `bundles`: the simulators of a process share a session, and are asked by one message.

The numbers go to `results/many_simulators.json`, those of another way than `in_turn` with its name.
"""

import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any, Final, Literal

import psutil
import tyro
from msgspec.structs import asdict

from benchmarks.bus import payloads
from benchmarks.bus.lockstep import cpu_of
from benchmarks.report import write_report
from legpush.bus.bundles.asking import AskingSession
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, by_router, free_ports
from legpush.bus.session import ZenohSession
from legpush.bus.transport import Session
from legpush.errors import PeerError
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.lockstep.server import serve_actions
from legpush.lockstep.sim_host import SimConfig, buses, member_name, serve_each
from legpush.messages.stepping import Motion, Walk
from legpush.patience import Patience
from legpush.soak.resources import Sample, growth, sample
from legpush.soak.stub_simulator import StubSimulator, chained

RUN: Final = "bench"
HOST: Final = "host"
"""First word of the processes that this program starts."""
EPISODE_STEPS: Final = 50
N_SAMPLES: Final = 40
PATIENCE: Final = Patience(deadline_s=30.0, resend_s=2.0, resend_at_most_s=5.0)


@dataclass(frozen=True, kw_only=True)
class Config:
    """How many, and for how long."""

    simulators: int = 200
    processes: int = 20
    seconds: float = 120.0
    """How long they are stepped."""
    find_s: float = 120.0
    """Longest time until all are found."""
    way: Literal["in_turn", "alone", "bundles"] = "in_turn"
    """How the simulators of a process are stepped."""

    @property
    def name(self) -> str:
        """Of the file of results."""
        return "many_simulators" if self.way == "in_turn" else f"many_simulators_{self.way}"


@dataclass
class Stepped:
    """What came of one simulator."""

    n_steps: int = 0
    longest_s: float = 0.0
    """Longest time of a step."""
    n_wrong: int = 0
    """Steps whose state was not the one that follows from all motions before."""
    lost: str = ""
    """Why it was given up."""


def main(config: Config) -> None:
    """Measure and report the numbers."""
    with ExitStack() as stack:
        routers, processes = start_all(stack, config)
        open_session = asking_session if config.way == "bundles" else None
        bus = stack.enter_context(Bus(RUN, "agent", "main", by_router(routers[:1]), open_session=open_session))
        began = perf_counter()
        found = find(bus, config)
        found_s = perf_counter() - began
        bus.announce()
        samples: dict[str, list[Sample]] = {name: [] for name in processes}
        cpu_s = {name: cpu_of(process.pid) for name, process in processes.items()}
        began = perf_counter()
        stepped = step_all(bus, found, config, processes, samples)
        took_s = perf_counter() - began
        used_s = {name: cpu_of(process.pid) - cpu_s[name] for name, process in processes.items()}
    numbers = {
        "way": config.way,
        "simulators": config.simulators,
        "processes": config.processes,
        "routers": len(routers),
        "found": len(found),
        "found_s": round(found_s, 1),
        **reported(list(stepped.values()), took_s, used_s),
        "growth": grown(samples),
    }
    write_report(config.name, numbers)


def start_all(stack: ExitStack, config: Config) -> tuple[tuple[str, ...], dict[str, psutil.Process]]:
    """Start two routers and the processes of the simulators; returns endpoints, and all processes with this one."""
    ports = free_ports(("planner", "sim")).values()
    routers = tuple(f"tcp/127.0.0.1:{port}" for port in ports)
    legpush = (sys.executable, "-c", "import sys; from legpush.cli import main; sys.exit(main())")
    processes = {"learner": psutil.Process()}
    for number, at in enumerate(routers):
        others = ("--connect", routers[0]) if number else ()
        words = (*legpush, "router", "-q", "--listen", at, *others)
        processes[f"router {number}"] = psutil.Process(started(stack, words))
    host = (sys.executable, "-m", "benchmarks.bus.many_simulators", HOST, config.way)
    for number, names in enumerate(of_processes(config)):
        words = (*host, routers[number % 2], f"p{number:02}", str(len(names)))
        processes[f"simulators {number}"] = psutil.Process(started(stack, words))
    return routers, processes


def of_processes(config: Config) -> list[list[str]]:
    """Return the names of the simulators of each process."""
    each, more = divmod(config.simulators, config.processes)
    return [
        [member_name(f"p{number:02}", index + 1) for index in range(each + (number < more))]
        for number in range(config.processes)
    ]


def asking_session(at: Endpoints, who: str) -> Session:
    """Open a session that asks simulators of a process together."""
    return AskingSession(ZenohSession(at, who), RUN)


def started(stack: ExitStack, words: Sequence[str]) -> int:
    """Start a process that ends with the stack; returns its id."""
    process = subprocess.Popen(words, cwd=Path(__file__).parents[2])
    stack.callback(process.wait)
    stack.callback(process.kill)
    return process.pid


def find(bus: Bus, config: Config) -> tuple[str, ...]:
    """Return the names of all simulators that are seen in time."""
    until, pause = perf_counter() + config.find_s, threading.Event()
    while True:
        names = tuple(sorted({peer.name for peer in bus.liveliness.live("sim")}))
        if len(names) >= config.simulators or perf_counter() > until:
            return names
        pause.wait(0.1)


def step_all(
    bus: Bus,
    names: Sequence[str],
    config: Config,
    processes: Mapping[str, psutil.Process],
    samples: Mapping[str, list[Sample]],
) -> dict[str, Stepped]:
    """Step all simulators for a while, some in turn on each thread, and look at the processes meanwhile."""
    stop, never, stepped = threading.Event(), threading.Event(), {name: Stepped() for name in names}
    worlds = {name: BusWorld(SimLink(bus, name, stop=never, patience=PATIENCE)) for name in names}
    together = config.way != "in_turn"
    with ThreadPoolExecutor(config.processes) as threads, ThreadPoolExecutor(max(1, len(names))) as steppers:
        work = [
            threads.submit(
                step_some,
                {name: worlds[name] for name in group if name in worlds},
                stepped,
                stop,
                steppers if together else None,
            )
            for group in of_processes(config)
        ]
        for _ in range(N_SAMPLES):
            stop.wait(config.seconds / N_SAMPLES)
            for name, process in processes.items():
                samples[name].append(sample(process))
        stop.set()
        for each in work:
            each.result()
    return stepped


def step_some(
    worlds: Mapping[str, BusWorld],
    stepped: Mapping[str, Stepped],
    stop: threading.Event,
    steppers: ThreadPoolExecutor | None,
) -> None:
    """Step these simulators until `stop`, in episodes: in turn, or in the same moment by several threads."""
    crcs = dict.fromkeys(worlds, 0)

    def step(name: str) -> None:
        one = stepped[name]
        if one.lost:
            return
        motion: Motion = Walk() if one.n_steps % EPISODE_STEPS else payloads.reset()
        crcs[name] = chained(crcs[name], motion)
        began = perf_counter()
        try:
            one.n_wrong += worlds[name].step(motion).state_crc != crcs[name]
        except PeerError as error:
            one.lost = str(error)
            return
        one.longest_s = max(one.longest_s, perf_counter() - began)
        one.n_steps += 1

    while not stop.is_set():
        if steppers is None:
            for name in worlds:
                step(name)
        else:
            wait([steppers.submit(step, name) for name in worlds])


def reported(stepped: Sequence[Stepped], took_s: float, used_s: Mapping[str, float]) -> dict[str, Any]:
    """Return rates and fairness; a step has two messages."""
    n_steps = [one.n_steps for one in stepped]
    cpu_s = sum(used_s.values())
    return {
        "seconds": round(took_s, 1),
        "n_steps": sum(n_steps),
        "n_wrong": sum(one.n_wrong for one in stepped),
        "n_lost": len(lost := [one.lost for one in stepped if one.lost]),
        "lost": lost,
        "steps_of_one": {"least": min(n_steps), "median": median(n_steps), "most": max(n_steps)},
        "longest_step_s": round(max(one.longest_s for one in stepped), 3),
        "messages_per_s": round(2 * sum(n_steps) / took_s),
        "cores_used": round(cpu_s / took_s, 2),
        "messages_per_core_s": round(2 * sum(n_steps) / cpu_s),
        "cpu_us_per_message": {
            kind: round(1e6 * sum(s for name, s in used_s.items() if name.startswith(kind)) / (2 * sum(n_steps)), 1)
            for kind in ("learner", "router", "simulators")
        },
    }


def grown(samples: Mapping[str, Sequence[Sample]]) -> dict[str, Any]:
    """Return by how much the processes of each kind grew: the one that grew most."""
    found = {name: each for name, taken in samples.items() if (each := growth(taken)) is not None}
    return {
        kind: asdict(max((each for name, each in found.items() if name.startswith(kind)), key=lambda each: each.memory))
        for kind in ("learner", "router", "simulators")
        if found
    }


def host(way: str, router: str, name: str, n: int) -> None:
    """Be some simulators until this process is killed."""
    at = by_router((router,))
    if way == "bundles":
        with buses(SimConfig(run=RUN, name=name, simulators=n), at, threading.Event()) as members:
            serve_each(members, lambda _: StubSimulator(), threading.Event())
    for number in range(1, n + 1):
        threading.Thread(target=serve, args=(at, member_name(name, number)), daemon=True).start()
    threading.Event().wait()


def serve(at: Endpoints, name: str) -> None:
    """Be one simulator, with a session of its own."""
    with Bus(RUN, "sim", name, at) as bus:
        serve_actions(bus, StubSimulator(), threading.Event())


if __name__ == "__main__":
    if sys.argv[1:2] == [HOST]:
        host(sys.argv[2], sys.argv[3], sys.argv[4], int(sys.argv[5]))
    else:
        main(tyro.cli(Config))
