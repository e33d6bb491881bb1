"""A planner that is broken on purpose: `faulty_planner.py FAULT [FLAGS]`; the example, with that fault."""

import importlib
import random
import sys
import time
from math import degrees, pi
from pathlib import Path
from types import ModuleType
from typing import Any

import msgpack

EXAMPLES = Path(__file__).parents[2] / "examples"
LONG_ITERATIONS = 1_000_000
"""Who asks for more means to cancel."""
REVISIONS = {
    "skips a revision": (0, 2, 3),
    "never is done": (0, 1, 2),
    "gets worse": (0, 1, 2, 3),
}
"""What it publishes where better plans are asked for."""


def load() -> ModuleType:
    """The example as a module."""
    sys.path.insert(0, str(EXAMPLES))
    return importlib.import_module("grid_planner")


def break_plans(fault: str, planner: ModuleType) -> None:
    """Let its plans have the fault."""
    honest, by_start = planner.plan_trunk, random.random()

    def plan(query: dict[str, Any]) -> dict[str, Any]:
        match fault:
            case "hangs":
                time.sleep(60.0)
            case "hangs on an open floor" if query["goal"]["y_m"] == 5.0:
                time.sleep(60.0)
            case "ignores a cancel" if query["max_iterations"] > LONG_ITERATIONS:
                time.sleep(60.0)
            case "collides":
                query = {**query, "clearance_m": 0.05}
            case "turns too tightly":
                query = {**query, "min_turning_radius_m": 0.6 * query["min_turning_radius_m"]}
            case "lies":
                return {"status": "failed", "reason": "could not be bothered"}
            case "dies":
                sys.exit("out of ideas")
        found: dict[str, Any] = honest(query) if query["steering"] == "straight" else steered(query)
        waypoints = found.get("waypoints", [])
        match fault:
            case "ignores the seed":
                found["length_m"] += random.random()
            case "draws a seed when it starts":
                found["length_m"] += by_start
            case "centimetres":
                found["waypoints"] = [{**p, "x_m": 100 * p["x_m"], "y_m": 100 * p["y_m"]} for p in waypoints]
            case "degrees":
                found["waypoints"] = [{**p, "yaw_rad": degrees(p["yaw_rad"])} for p in waypoints]
            case "drives backward":
                between = [{**p, "yaw_rad": p["yaw_rad"] - pi} for p in waypoints[1:-1]]
                found["waypoints"] = [waypoints[0], *between, waypoints[-1]]
            case "stops short":
                found["waypoints"] = waypoints[: len(waypoints) // 2]
            case "invents fields":
                found["mood"] = "sunny"
        return found

    vars(planner)["plan_trunk"] = plan


def steered(query: dict[str, Any]) -> dict[str, Any]:
    """What the built-in planner finds, loaded where it is wanted: it takes long."""
    from legpush.messages import codec
    from legpush.messages.planning import TrunkPathQuery
    from planner_proc.planning import make_plan

    found: dict[str, Any] = codec.unpack(codec.encode(make_plan(codec.convert(query, TrunkPathQuery))))
    return found


def break_answers(fault: str, planner: ModuleType) -> None:
    """Let it publish what the fault makes of an answer."""
    put, answer = planner.zenoh.Session.put, planner.answer

    def publish(session: Any, key: str, payload: bytes, **options: Any) -> None:
        result = msgpack.unpackb(payload)
        for revision in REVISIONS.get(fault, (0, 0) if fault == "answers twice" else (0,)):
            revised = {**result, "revision": revision, "final": fault not in REVISIONS or revision == 3}
            if fault == "gets worse":
                revised["plan"] = {**result["plan"], "length_m": 1.1**revision * result["plan"]["length_m"]}
            put(session, key, msgpack.packb(revised), **options)

    planner.zenoh.Session.put = publish
    if fault == "takes a restarted client for the old one":
        vars(planner)["answer"] = lambda client, _, *rest: answer(client, "whoever", *rest)


if __name__ == "__main__":
    wanted = sys.argv.pop(1)
    module = load()
    break_plans(wanted, module)
    break_answers(wanted, module)
    module.main()
