"""A planner that is broken on purpose: `faulty_planner.py FAULT [FLAGS]`; the example's messages, our own paths."""

import importlib.util
import itertools
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import msgspec

from legpush import codec
from legpush.messages import TrunkPathQuery
from planner_proc.planning import make_plan

EXAMPLE = Path(__file__).parents[2] / "examples" / "grid_planner.py"


def load() -> ModuleType:
    """The example as a module."""
    spec = importlib.util.spec_from_file_location("grid_planner", EXAMPLE)
    if spec is None or spec.loader is None:
        raise RuntimeError(f"Expected a module in {EXAMPLE}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def broken(fault: str, planner: ModuleType) -> None:
    """Let its plans have the fault."""
    counter = itertools.count()

    def plan(query: dict[str, Any]) -> dict[str, Any]:
        match fault:
            case "hangs":
                time.sleep(60.0)
            case "collides":
                query = {**query, "clearance_m": 0.05}
            case "lies":
                return {"status": "failed", "reason": "could not be bothered"}
            case "dies":
                sys.exit("out of ideas")
        found: dict[str, Any] = msgspec.to_builtins(make_plan(codec.convert(query, TrunkPathQuery)))
        match fault:
            case "random":
                found["length_m"] += 1e-9 * next(counter)
            case "centimetres":
                found["waypoints"] = [{**p, "x_m": 100 * p["x_m"], "y_m": 100 * p["y_m"]} for p in found["waypoints"]]
            case "stops short":
                found["waypoints"] = found["waypoints"][: len(found["waypoints"]) // 2]
            case "invents fields":
                found["mood"] = "sunny"
        return found

    vars(planner)["plan_trunk"] = plan
    if fault == "twice":
        put = planner.zenoh.Session.put

        def twice(session: Any, *args: Any, **options: Any) -> None:
            put(session, *args, **options)
            put(session, *args, **options)

        planner.zenoh.Session.put = twice


if __name__ == "__main__":
    module = load()
    broken(sys.argv.pop(1), module)
    module.main()
