"""The simulator as a process: its command line and its work."""

import threading

from legpush.bus.bus import Bus
from legpush.lockstep.server import serve_actions
from legpush.service import ServiceConfig, run_process


def serve(_: ServiceConfig, bus: Bus, stop: threading.Event) -> None:
    """Carry out actions until `stop` is set."""
    from sim_proc.described_simulator import DescribedSimulator

    serve_actions(bus, DescribedSimulator(bus), stop)


def main() -> int:
    """Run the process; returns the exit code."""
    return run_process("sim", ServiceConfig, serve)
