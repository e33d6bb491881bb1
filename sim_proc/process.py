"""The simulator as a process: its command line and its work."""

from legpush.bus.bus import Bus
from legpush.lockstep.sim_host import run_simulators
from legpush.lockstep.simulator import Stepper


def make(bus: Bus) -> Stepper:
    """Make the simulator whose actions come over this bus."""
    from sim_proc.described_simulator import DescribedSimulator

    return DescribedSimulator(bus)


def main() -> int:
    """Run the process; returns the exit code."""
    return run_simulators(make)
