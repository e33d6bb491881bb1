"""The planner as a process: its command line and its work."""

import threading

from legpush.bus.bus import Bus
from legpush.plans.server import serve_plans
from legpush.service import ServiceConfig, run_process


def serve(_: ServiceConfig, bus: Bus, stop: threading.Event) -> None:
    """Answer plan requests until `stop` is set."""
    from planner_proc.planning import make_plans

    serve_plans(bus, make_plans, stop)


def main() -> int:
    """Run the process; returns the exit code."""
    return run_process("planner", ServiceConfig, serve)
