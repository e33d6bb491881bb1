"""`python -m benchmarks.bus.lockstep`: a round trip of the lockstep beside other transports, for the same bytes.

Of each size, all transports take turns in short blocks, so that other work on the machine affects them equally. A ratio
is one of blocks of the same round. CPU is that of both ends. The numbers go to `results/lockstep.json`.
"""

import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any, Final

import tyro

from agent_proc.statistics.intervals import median
from agent_proc.statistics.paired import paired_ratio
from benchmarks.bus import payloads
from benchmarks.bus.transports import ROUTED, TRANSPORTS, Ask, router_at
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.authority.carry_out import begin
from legpush.bus.endpoints import Endpoints
from legpush.bus.links.configuration import configuration
from legpush.bus.session import publisher_settings

SECURE: Final = ("legpush tcp", "legpush tls")
PAIRS: Final = {"tls_over_tcp": ("legpush tls", "legpush tcp"), "over_zenoh_by_router": ROUTED}
"""Further ratios, of which both ends differ from the lockstep between peers."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    transports: tuple[str, ...] = tuple(TRANSPORTS)
    sizes: tuple[int, ...] = (1_000, 10_000, 1_000_000)
    """Bytes of the answers, about; the question is a `Walk`."""
    n_rounds: int = 30
    seconds: float = 0.1
    """About how long a block takes."""
    name: str = "lockstep"
    """Of the file of results."""


@dataclass(frozen=True)
class Block:
    """Mean times of a round trip in one block."""

    wall_us: float
    cpu_us: float


def main(config: Config) -> None:
    """Measure and report the numbers."""
    missing = {
        name: library for name in config.transports if (library := TRANSPORTS[name][2]) and not find_spec(library)
    }
    for name, library in missing.items():
        print(f"{name} is left out: {library} is not installed (pip install 'legpush[bench]')")
    chosen = [name for name in config.transports if name not in missing]
    measured = {str(n_bytes): reported(measure(chosen, n_bytes, config), n_bytes) for n_bytes in config.sizes}
    write_report(
        config.name,
        {
            "n_rounds": config.n_rounds,
            "settings": {"legpush": zenoh_settings(), "zenoh": zenoh_settings()},
            "missing": missing,
            "sizes": measured,
        },
    )


def zenoh_settings() -> dict[str, Any]:
    """Return the settings of Zenoh that both the lockstep and Zenoh alone have, without their endpoints."""
    return {
        "session": configuration(Endpoints()),
        "publisher": {key: str(value) for key, value in publisher_settings("lockstep").items()},
    }


def measure(names: list[str], n_bytes: int, config: Config) -> dict[str, list[Block]]:
    """Return the blocks of each transport, with answers of one size."""
    blocks: dict[str, list[Block]] = {name: [] for name in names}
    with ExitStack() as stack:
        ends = {name: stack.enter_context(opened(name, n_bytes)) for name in names}
        n_asked = {name: warmed_up(ask, config.seconds) for name, (ask, _) in ends.items()}
        for index in range(config.n_rounds):
            first = index % len(names)
            for name in (*names[first:], *names[:first]):
                blocks[name].append(block(*ends[name], n_asked[name]))
    return blocks


@contextmanager
def opened(name: str, n_bytes: int) -> Iterator[tuple[Ask, int]]:
    """Start the end that answers; gives what asks it, and its process."""
    ask, _, _ = TRANSPORTS[name]
    with TemporaryDirectory(prefix="legpush-bench-") as scratch:
        folder = Path(scratch)
        if name == "legpush tls":
            begin(folder / "authority", ("host=127.0.0.1",), 90, 90)
            (folder / "host").symlink_to(folder / "authority" / "host")
        argv = [sys.executable, "-m", "benchmarks.bus.transports", name, scratch, str(n_bytes)]
        with routing(folder) if name in ROUTED else nullcontext(), subprocess.Popen(argv) as answering:
            try:
                with ask(name, folder) as asking:
                    yield asking, answering.pid
            finally:
                answering.kill()


@contextmanager
def routing(folder: Path) -> Iterator[None]:
    """Run a router; its ends wait for it."""
    legpush = "import sys; from legpush.cli import main; sys.exit(main())"
    with subprocess.Popen([sys.executable, "-c", legpush, "router", "-q", "--listen", router_at(folder)]) as router:
        try:
            yield
        finally:
            router.kill()


def warmed_up(ask: Ask, seconds: float) -> int:
    """Return how many round trips take about this time."""
    for n in (5, 50):
        began = perf_counter()
        for _ in range(n):
            ask()
        each_s = (perf_counter() - began) / n
    return max(3, round(seconds / each_s))


def block(ask: Ask, pid: int, n: int) -> Block:
    """Measure `n` round trips."""
    cpu_s, began = process_time() + cpu_of(pid), perf_counter()
    for _ in range(n):
        ask()
    wall_s = perf_counter() - began
    return Block(1e6 * wall_s / n, 1e6 * (process_time() + cpu_of(pid) - cpu_s) / n)


def cpu_of(pid: int) -> float:
    """CPU seconds of the living threads of a process, to the nanosecond."""
    return 1e-9 * sum(int(path.read_text().split()[0]) for path in Path(f"/proc/{pid}/task").glob("*/schedstat"))


def reported(blocks: Mapping[str, list[Block]], n_bytes: int) -> dict[str, Any]:
    """Return the medians of each transport, and the ratios of the lockstep to each other one."""
    by_round = {
        measure: {name: dict(enumerate(getattr(one, measure) for one in each)) for name, each in blocks.items()}
        for measure in ("wall_us", "cpu_us")
    }
    numbers: dict[str, Any] = {
        "n_bytes": len(payloads.answer(n_bytes)),
        "n_bytes_question": len(payloads.question()),
        "transports": {
            name: {m: plain(median(list(values[name].values())), 1) for m, values in by_round.items()}
            for name in blocks
        },
    }
    for measure, values in by_round.items():
        for name in blocks:
            if name != "legpush" and "legpush" in blocks and name not in (*SECURE, *ROUTED):
                key = f"{measure.removesuffix('_us')}_over_{name}"
                numbers[key] = plain(paired_ratio(values["legpush"], values[name]), 3)
        for key, (above, below) in PAIRS.items():
            if {above, below} <= set(blocks):
                numbers[f"{measure.removesuffix('_us')}_{key}"] = plain(paired_ratio(values[above], values[below]), 3)
    return numbers


if __name__ == "__main__":
    main(tyro.cli(Config))
