"""The simulator as a process of its own: `python -m sim_proc`."""

import sys
import threading

from legpush.bus.bus import Bus
from legpush.lockstep.server import serve_actions
from legpush.numerics.entry import enter_profile
from legpush.service import ServiceConfig, run_process


def serve(_: ServiceConfig, bus: Bus, stop: threading.Event) -> None:
    """Carry out actions until `stop` is set."""
    from sim_proc.described_simulator import DescribedSimulator

    serve_actions(bus, DescribedSimulator(bus), stop)


if __name__ == "__main__":
    enter_profile()
    sys.exit(run_process("sim", ServiceConfig, serve))
