"""`python -m benchmarks.planners.speed`: measures the time to the first exact path, and the memory it takes.

Plans are asked for in this process and over the bus, on the published map and on large ones. The numbers go to
`results/planner_speed.json`.
"""

import re
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Final

import numpy as np
import psutil
import tyro
from msgspec.structs import replace

from agent_proc.statistics.intervals import median
from benchmarks.planners.maps import HUGE, LARGE, question
from benchmarks.report import write_report
from experiments.rows import Row
from experiments.tables.parts import plain
from legpush.bus.bus import Bus
from legpush.messages import codec
from legpush.messages.planning import Plan, TrunkPathQuery
from legpush.plans.client import PlanLink
from planner_proc.clearance.field import ClearanceField
from planner_proc.conformance.client import RUN, PlannerProcess
from planner_proc.planning import make_plan
from planner_proc.search.registry import routes

MB: Final = 1e6


@dataclass(frozen=True, kw_only=True)
class Speed:
    """Time the planner of missions on the published map, one of 200 x 200 m and one of 4000 x 4000 cells."""

    n: int = 101
    """Number of seeds on the published map."""
    n_large: int = 15
    """Number of seeds on each of the large maps."""


def main(config: Speed) -> None:
    """Measure and report."""
    sizes = (("published", config.n), (LARGE, config.n_large), (HUGE, config.n_large))
    summary: dict[str, Row] = {name: {"n": n} for name, n in sizes}
    plans: dict[tuple[str, int], bytes] = {}
    for name, n in sizes:
        summary[name]["in the process"], found = _in_process(question(name), n)
        plans |= {(name, seed): plan for seed, plan in enumerate(found)}
        summary[name]["parts"] = _parts(question(name), min(n, 31))
    for name, n in sizes:
        # Each map gets its own process, so that the peak memory is that of this map.
        with _planner() as (link, process):
            times_s, equal = [], 0
            for seed in range(n):
                query = _query(question(name), seed)
                begin_s = perf_counter()
                plan = link.plan(query)
                times_s.append(perf_counter() - begin_s)
                equal += codec.encode(plan) == plans[name, seed]
            summary[name]["over the bus"] = _ms(times_s[1:])
            summary[name]["over the bus, first request"] = round(1e3 * times_s[0], 2)
            summary[name]["equal to the plan of this process, bit for bit"] = equal
            summary[name]["peak memory of the planner's process [MB]"] = round(_peak_bytes(process) / MB, 1)
    write_report("planner_speed", {"maps": summary})


def _in_process(question_: TrunkPathQuery, n: int) -> tuple[Row, list[bytes]]:
    """Return wall and processor times of whole plans, and the plans."""
    make_plan(_query(question_, 0))
    wall_s, cpu_s, plans = [], [], []
    for seed in range(n):
        query = _query(question_, seed)
        begin_s, begin_cpu_s = perf_counter(), process_time()
        plan = make_plan(query)
        wall_s.append(perf_counter() - begin_s)
        cpu_s.append(process_time() - begin_cpu_s)
        _require_exact(plan)
        plans.append(codec.encode(plan))
    return {"wall": _ms(wall_s), "processor": _ms(cpu_s)}, plans


def _parts(question_: TrunkPathQuery, n: int) -> Row:
    """Return the processor times of the distance field, of the search, and of the rest."""
    parts: dict[str, list[float]] = {"field": [], "search": [], "shortening, smoothing, checking": []}
    for seed in range(n):
        query = _query(question_, seed)
        times_s = [process_time()]
        field = ClearanceField(query.grid)
        times_s.append(process_time())
        next(routes(query, field, lambda: False))
        times_s.append(process_time())
        make_plan(query)
        whole_s = process_time() - times_s[-1]
        field_s, search_s = np.diff(times_s).tolist()
        for key, part_s in zip(parts, (field_s, search_s, whole_s - field_s - search_s), strict=True):
            parts[key].append(part_s)
    return {key: _ms(times) for key, times in parts.items()}


@contextmanager
def _planner() -> Iterator[tuple[PlanLink, psutil.Process]]:
    """Start a planner process; yields the link of an agent to it, and the process."""
    stop = threading.Event()
    with ExitStack() as stack:
        logs = Path(stack.enter_context(TemporaryDirectory(prefix="legpush-planners-")))
        started = PlannerProcess((sys.executable, "-m", "planner_proc"), logs / "planner.log", stop)
        before = set(psutil.Process().children(recursive=True))
        started = stack.enter_context(started)
        bus = stack.enter_context(Bus(RUN, "agent", "speed", started.endpoints))
        link = PlanLink(bus, stop=stop)
        bus.announce()
        while len(bus.liveliness.live("planner")) != 1:
            if ended := started.end():
                raise RuntimeError(f"Expected a planner that starts, but it ended: {ended}")
            threading.Event().wait(0.01)
        new = set(psutil.Process().children(recursive=True)) - before
        yield link, next(process for process in new if "planner_proc" in process.cmdline())


def _peak_bytes(process: psutil.Process) -> int:
    """Return the largest resident memory that a process has had."""
    found = re.search(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{process.pid}/status").read_text())
    if found is None:
        raise RuntimeError(f"Expected VmHWM in the status of process {process.pid}")
    return 1024 * int(found[1])


def _query(query: TrunkPathQuery, seed: int) -> TrunkPathQuery:
    return replace(query, planner="rrt_connect", seed=seed)


def _require_exact(plan: Plan) -> None:
    if plan.status != "exact":
        raise RuntimeError(f"Expected an exact plan, got {plan.status}: {plan.reason}")


def _ms(times_s: list[float]) -> Row:
    best, worst = 1e3 * min(times_s), 1e3 * max(times_s)
    return {
        "median_ms": plain(median(times_s).scaled(1e3), 2),
        "fastest_ms": round(best, 2),
        "slowest_ms": round(worst, 2),
    }


if __name__ == "__main__":
    main(tyro.cli(Speed))
