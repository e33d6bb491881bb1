"""Many lockstep steps with a stub simulator: none is lost or repeated, and memory, threads and open files stay flat."""

import threading
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Final

import psutil
from msgspec import Struct

from legpush.bus.bus import Bus
from legpush.errors import DivergedError
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.messages.stepping import Motion, Push, Reset
from legpush.processes.pool import SimPool
from legpush.scenarios.file import load_scenario
from legpush.soak.resources import Growth, Sample, growths, sample
from legpush.soak.stub_simulator import chained

EPISODE_STEPS: Final = 1000
N_SAMPLES: Final = 200
STUB: Final = ("-m", "legpush.soak.stub_simulator")


class StepsResult(Struct, frozen=True, kw_only=True):
    """What came of the steps of one command."""

    n_steps: int
    steps_per_s: float
    growth: dict[str, Growth | None]
    """Of this process, which is the agent, and of the simulator; None for too few samples."""

    @property
    def is_flat(self) -> bool:
        """Whether no process grew."""
        return all(each is None or each.is_flat for each in self.growth.values())


def run_steps(
    n_steps: int, logs: Path, stop: threading.Event, progress: Callable[[int], None] = lambda n_done: None
) -> StepsResult:
    """Do this many steps, or as many as are done when `stop` is set.

    Raises:
        DivergedError: A step was lost, repeated or altered.
        PeerError: The simulator does not answer.
    """
    reset = Reset(scenario=load_scenario("push"), seed=0)
    samples: dict[str, list[Sample]] = {"agent": [], "sim": []}
    every = max(1, n_steps // N_SAMPLES)
    with (
        SimPool(1, logs, stop, kind="soak", program=STUB) as pool,
        Bus(pool.run, "agent", "main", pool.endpoints) as bus,
    ):
        world = BusWorld(SimLink(bus, pool.names[0], stop=stop))
        bus.announce()
        crc, n_done, began_s = 0, 0, perf_counter()
        while n_done < n_steps and not stop.is_set():
            place = n_done % EPISODE_STEPS
            motion: Motion = reset if place == 0 else _push(place)
            crc = chained(crc, motion)
            got = world.step(motion).state_crc
            if got != crc:
                raise DivergedError(f"Expected state {crc:08x} after step {n_done}, got {got:08x}: a step was lost")
            n_done += 1
            if n_done % every == 0:
                for name, process in (("agent", psutil.Process()), ("sim", _simulator(pool.names[0]))):
                    samples[name].append(sample(process))
                progress(n_done)
        took_s = perf_counter() - began_s
    return StepsResult(n_steps=n_done, steps_per_s=round(n_done / took_s, 1), growth=growths(samples))


def _push(place: int) -> Push:
    """A push that differs from those before it in the episode."""
    return Push(w1=place / EPISODE_STEPS, w2=0.5, leg="FL", depth_m=0.1)


def _simulator(name: str) -> psutil.Process:
    return next(child for child in psutil.Process().children(recursive=True) if name in child.cmdline())
