"""The planner as a process of its own: `python -m planner_proc`."""

import sys
import threading

from legpush.bus.bus import Bus
from legpush.numerics.entry import enter_profile
from legpush.plans.server import serve_plans
from legpush.service import ServiceConfig, run_process


def serve(_: ServiceConfig, bus: Bus, stop: threading.Event) -> None:
    """Answer plan requests until `stop` is set."""
    from planner_proc.planning import make_plans

    serve_plans(bus, make_plans, stop)


if __name__ == "__main__":
    enter_profile()
    sys.exit(run_process("planner", ServiceConfig, serve))
