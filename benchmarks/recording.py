"""`python -m benchmarks.recording`: measures what a recording costs, and whether it is complete.

Whole missions with and without a recorder take turns. Then a lockstep without physics runs as fast as it can: without a
recorder, with one, and with a frozen one. Simulator and recorder are processes of their own. The numbers go to
`results/recording.json`.
"""

import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro

from agent_proc.statistics.paired import paired_ratio
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.bus.bus import Bus
from legpush.bus.endpoints import in_directory
from legpush.lockstep.client import PastStep, SimLink
from legpush.messages.stepping import Alter, Motion, Reset
from legpush.recording.mcap_file.reader import read_recording
from legpush.runs.report import read_report
from legpush.scenarios.file import load_scenario

RUN = "benchmark"
CLI = "import sys; from legpush.cli import main; sys.exit(main())"


@dataclass(frozen=True, kw_only=True)
class Config:
    """Length of the measurement."""

    missions: int = 5
    """Number of missions with recording, and of missions without; 0 skips them."""
    scenario: str = "default"
    messages: int = 100_000
    """Number of messages of the lockstep without physics; half of them are actions."""


def main(config: Config) -> None:
    """Measure missions and lockstep, and report the results."""
    missions = measure_missions(config.missions, config.scenario) if config.missions else None
    with tempfile.TemporaryDirectory(prefix="legpush-recording-") as folder:
        lockstep = measure_lockstep(config.messages // 2, Path(folder))
    write_report("recording", {"missions": missions, "lockstep": lockstep})


def measure_missions(n: int, scenario: str) -> dict[str, Any]:
    """Compare the wall times of missions, from the first to the last entry of their journals."""
    seconds: dict[bool, list[float]] = {False: [], True: []}
    crcs = set()
    with tempfile.TemporaryDirectory(prefix="legpush-recording-") as folder:
        for index in range(n):
            for recorded in (False, True):
                out, file = Path(folder) / f"{index}-{recorded}", Path(folder) / f"{index}.mcap"
                command = [sys.executable, "-c", CLI, "run", scenario, "--out", str(out)]
                command += ["--no-video", *(("--record", str(file)) if recorded else ())]
                subprocess.run(command, check=True, capture_output=True)
                report = read_report(out)
                seconds[recorded].append(report["wall_time_s"])
                crcs.add(report["state_crc"])
                if recorded and not report["recording"]["complete"]:
                    raise RuntimeError(f"The recording is not complete: {report['recording']['notes']}")
    without, with_ = (statistics.median(seconds[recorded]) for recorded in (False, True))
    ratio = paired_ratio(dict(enumerate(seconds[True])), dict(enumerate(seconds[False])))
    return {
        "scenario": scenario,
        "n": n,
        "median_without_s": round(without, 3),
        "median_with_s": round(with_, 3),
        "with_over_without": plain(ratio, 4),
        "n_end_states": len(crcs),
    }


def measure_lockstep(n_steps: int, folder: Path) -> dict[str, Any]:
    """Compare steps per second, and count the messages in the file."""
    folder.chmod(0o700)
    with ExitStack() as stack:
        stack.enter_context(process("sim", folder))
        bus = stack.enter_context(Bus(RUN, "agent", "main", in_directory(folder, "agent")))
        link = SimLink(bus, "main", stop=threading.Event())
        bus.announce()
        lockstep = Lockstep(link)
        lockstep.run(500)
        alone_hz = lockstep.run(n_steps // 10)
        file = folder / "recording.mcap"
        with process("recorder", folder, str(file)) as recorder:
            while not bus.liveliness.live("recorder"):
                time.sleep(0.01)
            recorded_hz, first = lockstep.run(n_steps), lockstep.n_steps - n_steps
            recorder.send_signal(signal.SIGSTOP)
            frozen_hz, longest_s = lockstep.run(n_steps // 5), lockstep.longest_s
            recorder.send_signal(signal.SIGCONT)
            while not bus.liveliness.live("recorder"):
                time.sleep(0.01)
            lockstep.run(100)
            time.sleep(1.0)
            recorder.send_signal(signal.SIGINT)
            recorder.wait()
    recording = read_recording([file])
    n_expected = 2 * (lockstep.n_steps - first)
    n_found = sum(message.topic in ("sim/main/action", "sim/main/observation") for message in recording.messages)
    return {
        "alone_hz": round(alone_hz),
        "recorded_hz": round(recorded_hz),
        "frozen_hz": round(frozen_hz),
        "recorded_over_alone": round(recorded_hz / alone_hz, 3),
        "frozen_over_alone": round(frozen_hz / alone_hz, 3),
        "frozen_longest_step_s": round(longest_s, 4),
        "n_messages": n_expected,
        "n_in_file": n_found,
        "n_missing_by_its_own_account": int(recording.completeness["n_missing"]),
        "file_mb": round(file.stat().st_size / 1e6, 1),
    }


class Lockstep:
    """An agent's end of a lockstep whose steps move nothing."""

    def __init__(self, link: SimLink) -> None:
        self._link = link
        self._past: list[PastStep] = []
        link.begin()
        self._step(Reset(scenario=load_scenario("push"), seed=0))
        self.longest_s = 0.0
        """Longest step of the last run."""

    @property
    def n_steps(self) -> int:
        """Number of steps up to now."""
        return len(self._past)

    def run(self, n: int) -> float:
        """Do n steps; return the steps per second."""
        self.longest_s = 0.0
        began = time.perf_counter()
        for _ in range(n):
            step_began = time.perf_counter()
            self._step(Alter())
            self.longest_s = max(self.longest_s, time.perf_counter() - step_began)
        return n / (time.perf_counter() - began)

    def _step(self, motion: Motion) -> None:
        self._past.append(PastStep(motion, self._link.step(motion, self._past).state_crc))


SIM = """
import sys, threading
from legpush.bus.bus import Bus
from legpush.bus.endpoints import in_directory
from legpush.lockstep.server import serve_actions
from legpush.messages.stepping import Reset
from legpush.service import stop_on_signals
from pathlib import Path
from sim_proc.simulator import Simulator

class Still:
    def perform(self, motion, *, with_trace):
        if isinstance(motion, Reset):
            self.outcome = Simulator().perform(motion, with_trace=with_trace)
        return self.outcome

stop = stop_on_signals()
with Bus("benchmark", "sim", "main", in_directory(Path(sys.argv[1]), "sim")) as bus:
    serve_actions(bus, Still(), stop)
"""


@contextmanager
def process(role: str, folder: Path, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """Start a simulator that answers at once, or a recorder."""
    if role == "sim":
        command = [sys.executable, "-c", SIM, str(folder)]
    else:
        connect = in_directory(folder, "recorder").connect
        command = [sys.executable, "-m", "legpush.launch.record", *arguments, "--run", RUN, "--connect", *connect]
    started = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield started
    finally:
        if started.poll() is None:
            started.send_signal(signal.SIGTERM)
        started.wait()


if __name__ == "__main__":
    main(tyro.cli(Config))
