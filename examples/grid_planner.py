"""A planner for legpush that needs only zenoh and msgpack: A* for the trunk; box_paths.py beside it adds the box.

    legpush run --planner-command "python examples/grid_planner.py"

It follows docs/protocol.md; copy and change it. docs/write_a_planner.md builds such a planner step by step. Points and
directions are complex numbers, x + iy: adding moves, multiplying turns.
"""

import argparse
import json
import os
import queue
import secrets
import sys
from cmath import phase
from collections import defaultdict
from contextlib import suppress
from heapq import heappop, heappush
from itertools import count, pairwise, product
from math import ceil, hypot, inf, sqrt

import msgpack
import zenoh
from box_paths import plan_box

VERSION = 10
LATTICE_M, WAYPOINT_M, CHECK_M = 0.1, 0.05, 0.025  # steps of A*, of a path, and of its check


def fits(grid, point, radius_m):
    """Whether a disc touches no occupied cell; looks at the part of each row of cells that the disc covers."""
    at, radius = (point - complex(*grid["origin_m"])) / grid["resolution_m"], radius_m / grid["resolution_m"]
    x, y, n_columns = at.real, at.imag, grid["n_columns"]
    if not (radius <= x <= n_columns - radius and radius <= y <= grid["n_rows"] - radius):
        return False
    for row in range(int(y - radius), ceil(y + radius)):
        half = sqrt(radius**2 - max(row - y, y - row - 1, 0.0) ** 2)
        if any(grid["cells"][row * n_columns + int(x - half) : row * n_columns + ceil(x + half)]):
            return False
    return True


def plan_trunk(query):
    if query["steering"] != "straight" or query["min_turning_radius_m"] > 0.0:
        return {"status": "invalid", "reason": "this planner only turns on the spot: it supports no turning radius"}
    start, goal = (complex(query[name]["x_m"], query[name]["y_m"]) for name in ("start", "goal"))
    clearance_m = query["clearance_m"]
    for name, point in (("start", start), ("goal", goal)):
        if not fits(query["grid"], point, clearance_m):
            reason = f"the {name} ({point.real}, {point.imag}) is less than {clearance_m} m from an obstacle"
            return {"status": "invalid", "reason": reason}
    radius_m = hypot(clearance_m, CHECK_M / 2)  # such discs, one at every step, cover the clearance of a line

    def is_free(a, b):
        return all(fits(query["grid"], point, radius_m) for point in line(a, b, CHECK_M))

    points = shortest(start, goal, is_free)
    if points is None:
        return {"status": "failed", "reason": f"no path on a lattice of {LATTICE_M} m"}
    corners, waypoints = [start], [query["start"]]
    while corners[-1] != goal:  # go on to the farthest point on a free straight line
        corners.append(next(point for point in reversed(points) if is_free(corners[-1], point)))
    for a, b in pairwise(corners):
        yaw_rad = phase(b - a)
        waypoints += [{"x_m": at.real, "y_m": at.imag, "yaw_rad": yaw_rad} for at in line(a, b, WAYPOINT_M)]
    return {
        "status": "exact",
        "reason": "",
        "waypoints": [*waypoints, query["goal"]],
        "raw_path_m": [(corner.real, corner.imag) for corner in corners],
        "length_m": sum(abs(b - a) for a, b in pairwise(corners)),
    }


def shortest(start, goal, is_free):
    """Return the path of A* over a lattice around the start, and the goal; None if there is no path."""
    end = (goal - start) / LATTICE_M  # nodes are lattice steps from the start
    steps = [complex(x, y) for x, y in product((-1, 0, 1), repeat=2) if x or y]
    costs, came_from, order = {0j: 0.0}, {}, count()
    waiting = [(abs(end), next(order), 0j)]
    while waiting:
        _, _, node = heappop(waiting)
        if node == end:
            way = [goal]
            while node != 0j:
                node = came_from[node]
                way.append(start + LATTICE_M * node)
            return way[::-1]
        for other in [node + step for step in steps] + [end] * (abs(end - node) < 2.0):
            cost = costs[node] + abs(other - node)
            if cost < costs.get(other, inf) and is_free(start + LATTICE_M * node, start + LATTICE_M * other):
                costs[other], came_from[other] = cost, node
                heappush(waiting, (cost + abs(end - other), next(order), other))
    return None


def line(a, b, step_m):
    n = max(1, ceil(abs(b - a) / step_m))
    return [a + (b - a) * k / n for k in range(n + 1)]


def answer(client, asker, number, query, answered):
    """Return the plan for a query (None: it is cancelled); the same plan if it is repeated, None if it is old."""
    last_asker, last_number, last_query, last_plan = answered.get(client, (None, None, None, None))
    if asker == last_asker and number < last_number:
        return None
    if (asker, number) == (last_asker, last_number):
        is_other = query and last_query and query != last_query
        return {"status": "invalid", "reason": f"{number} was the id of another query"} if is_other else last_plan
    if query is None:
        plan = {"status": "cancelled", "reason": "there was no plan yet"}
    else:
        plan = plan_trunk(query) if query["kind"] == "trunk_path" else plan_box(query, fits)
    answered[client] = asker, number, query, plan
    return plan


def main():
    parser = argparse.ArgumentParser(description="A planner for legpush")
    parser.add_argument("--run", default="local")
    parser.add_argument("--name", default="main")
    parser.add_argument("--listen", nargs="*", default=[f"unixsock-stream//tmp/legpush.{os.getuid()}/planner.sock"])
    parser.add_argument("--connect", nargs="*", default=[])
    options = parser.parse_args()
    off = {"enabled": False}
    config = {
        "mode": "peer",
        "listen": {"endpoints": options.listen},
        "connect": {"endpoints": options.connect},
        "scouting": {"multicast": off, "gossip": off},
        "transport": {"shared_memory": off, "link": {"tx": {"lease": 2000}}},
    }
    prefix, incarnation = f"legpush/v{VERSION}/{options.run}", secrets.token_hex(6)
    me = {"protocol": VERSION, "run": options.run, "role": "planner", "name": options.name, "incarnation": incarnation}
    inbox, answered, sequences = queue.Queue(), {}, defaultdict(count)
    with zenoh.open(zenoh.Config.from_json5(json.dumps(config))) as session:
        for kind in ("request", "cancel"):
            session.declare_subscriber(f"{prefix}/plan/*/{kind}", inbox.put)
        token = session.liveliness().declare_token(f"{prefix}/live/planner/{options.name}/{incarnation}")
        while token:
            sample = inbox.get()
            client, kind = str(sample.key_expr).split("/")[-2:]
            try:
                message = msgpack.unpackb(sample.payload.to_bytes())
                json.dumps(message, allow_nan=False, default=len)  # refuses numbers that are not finite
                header, number = message["header"], message["request_id"]
                if (header["protocol"], header["run"], header["name"]) != (VERSION, options.run, client):
                    raise ValueError(f"expected another sender than {header}")
                query = message["query"] if kind == "request" else None
                plan = answer(client, header["incarnation"], number, query, answered)
            except Exception as error:  # an invalid message gets no answer and does no harm
                print(f"not answered: {error!r}", file=sys.stderr)
                continue
            if plan is not None:
                mine = {
                    "header": {**me, "sequence": next(sequences[client])},
                    "revision": 0,
                    "final": True,
                    "plan": plan,
                }
                result = {**mine, "client_incarnation": header["incarnation"], "request_id": number}
                block = zenoh.CongestionControl.BLOCK
                session.put(f"{prefix}/plan/{client}/result", msgpack.packb(result), congestion_control=block)


if __name__ == "__main__":
    with suppress(KeyboardInterrupt):
        main()
