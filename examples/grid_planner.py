"""A planner for legpush in one file, with nothing but zenoh and msgpack: A* for the trunk, Dubins paths for the box.

    legpush run --planner-command "python examples/grid_planner.py"

Written from docs/protocol.md; a starting point for planners in any language. For the box it knows pushes from one side
only, on the shortest path of arcs and straight lines that is free.
"""

import argparse
import heapq
import json
import queue
import secrets
import sys
from contextlib import suppress
from math import atan2, ceil, cos, hypot, pi, sin, sqrt

import msgpack
import zenoh

VERSION, STEP_M, BOX_STEP_M = 4, 0.05, 0.025


class Map:
    """Which points keep a clearance, by the squares that are occupied."""

    def __init__(self, grid):
        self.resolution, (self.x0, self.y0) = grid["resolution_m"], grid["origin_m"]
        self.columns, self.rows, self.cells = grid["n_columns"], grid["n_rows"], grid["cells"]

    def cell(self, x, y):
        return int((x - self.x0) // self.resolution), int((y - self.y0) // self.resolution)

    def centre(self, cell):
        return self.x0 + (cell[0] + 0.5) * self.resolution, self.y0 + (cell[1] + 0.5) * self.resolution

    def solid(self, column, row):
        inside = 0 <= column < self.columns and 0 <= row < self.rows
        return not inside or self.cells[row * self.columns + column] != 0

    def clear(self, x, y, clearance):
        """Whether no occupied square is nearer to the point than that."""
        (left, bottom), (right, top) = self.cell(x - clearance, y - clearance), self.cell(x + clearance, y + clearance)
        for row in range(bottom, top + 1):
            dy = max(self.y0 + row * self.resolution - y, y - self.y0 - (row + 1) * self.resolution, 0.0)
            for column in range(left, right + 1):
                if self.solid(column, row):
                    dx = max(self.x0 + column * self.resolution - x, x - self.x0 - (column + 1) * self.resolution, 0.0)
                    if hypot(dx, dy) < clearance:
                        return False
        return True

    def clear_line(self, a, b, clearance):
        """The same all along a line, with what the distance can change by between two samples."""
        n = max(1, ceil(hypot(b[0] - a[0], b[1] - a[1]) / (0.25 * self.resolution)))
        slack = hypot(b[0] - a[0], b[1] - a[1]) / (2 * n)
        points = [(a[0] + (b[0] - a[0]) * k / n, a[1] + (b[1] - a[1]) * k / n) for k in range(n + 1)]
        ends = all(self.clear(*point, clearance) for point in (a, b))
        return ends and all(self.clear(*point, clearance + slack) for point in points[1:-1])


def plan_trunk(query):
    room, clearance = Map(query["grid"]), query["clearance_m"]
    start, goal = ((query[name]["x_m"], query[name]["y_m"]) for name in ("start", "goal"))
    for name, point in (("start", start), ("goal", goal)):
        if not room.clear(*point, clearance):
            return plan("invalid", f"the {name} {point} is nearer to something than {clearance} m")
    known = {}

    def safe(cell):  # anywhere in it the clearance is kept
        if cell not in known:
            known[cell] = room.clear(*room.centre(cell), clearance + sqrt(0.5) * room.resolution)
        return known[cell]

    def links(point):  # safe cells that a free line leads to, nearest first
        return [
            c for c in around(room.cell(*point), 3) if safe(c) and room.clear_line(point, room.centre(c), clearance)
        ]

    cells = search(safe, links(start), links(goal))
    if cells is None and not room.clear_line(start, goal, clearance):
        return plan("failed", "obstacles cut off the goal, at the resolution of the map")
    points = [start, *map(room.centre, cells or []), goal]
    corners, index = [start], 0
    while index < len(points) - 1:  # as far ahead as a line goes, by halves
        ahead = len(points) - 1
        while ahead > index + 1 and not room.clear_line(points[index], points[ahead], clearance):
            ahead = index + max(1, (ahead - index) // 2)
        index = ahead
        corners.append(points[index])
    way = [query["start"]]
    for a, b in zip(corners, corners[1:]):
        n = max(1, ceil(hypot(b[0] - a[0], b[1] - a[1]) / STEP_M))
        heading = atan2(b[1] - a[1], b[0] - a[0]) if a != b else query["goal"]["yaw_rad"]
        way += [pose(a[0] + (b[0] - a[0]) * k / n, a[1] + (b[1] - a[1]) * k / n, heading) for k in range(n + 1)]
    length = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(corners, corners[1:]))
    return plan("exact", f"{length:.2f} m", waypoints=[*way, query["goal"]], raw_path_m=corners, length_m=length)


def around(cell, n):
    cells = [(cell[0] + i, cell[1] + j) for i in range(-n, n + 1) for j in range(-n, n + 1)]
    return sorted(cells, key=lambda c: hypot(c[0] - cell[0], c[1] - cell[1]))


def search(safe, starts, goals):
    """A* over the eight neighbours of a cell, between the nearest cells; None where there is no way."""
    if not starts or not goals:
        return None
    goal, open_cells, came_from, cost = goals[0], [], {}, {starts[0]: 0.0}
    heapq.heappush(open_cells, (0.0, starts[0]))
    while open_cells:
        _, cell = heapq.heappop(open_cells)
        if cell == goal:
            cells = [cell]
            while cells[-1] in came_from:
                cells.append(came_from[cells[-1]])
            return cells[::-1]
        for other in around(cell, 1)[1:]:
            step = cost[cell] + hypot(other[0] - cell[0], other[1] - cell[1])
            if safe(other) and step < cost.get(other, 1e18):
                cost[other], came_from[other] = step, cell
                heapq.heappush(open_cells, (step + hypot(goal[0] - other[0], goal[1] - other[1]), other))
    return None


def plan_box(query):
    room, found = Map(query["grid"]), []
    for index, side in enumerate(query["sides"]):
        radius, frame = side["min_turning_radius_m"], side["frame"]
        begin, end = (compose(query[name], frame) for name in ("start", "goal"))
        before = compose(end, pose(-query["run_in_m"], 0.0, 0.0))
        run_in = (0.0, query["run_in_m"])
        words = ([*word, run_in] for word in dubins(begin, before, radius))
        found += [(sum(length for _, length in word), index, word) for word in words]
    for length, index, word in sorted(found, key=lambda one: one[0]):
        side = query["sides"][index]
        way = along(compose(query["start"], side["frame"]), word)
        if all(fits(room, at, side["footprints"], query["clearance_m"] + BOX_STEP_M) for at in way):
            boxes = [compose(at, inverse(side["frame"])) for at in way]
            return plan("exact", f"{length:.2f} m", waypoints=boxes, sides=[index] * len(boxes), length_m=length)
    return plan("failed", "no Dubins path from one side keeps clear; this planner knows no others")


def dubins(begin, end, radius):
    """Words of arc, line and arc, each part (curvature, length), from one pose to another."""
    at = compose(inverse(begin), end)
    for first in (1, -1):
        for last in (1, -1):  # centres of both circles, and the line that touches them
            x = at["x_m"] + last * radius * -sin(at["yaw_rad"])
            y = at["y_m"] + last * radius * cos(at["yaw_rad"]) - first * radius
            apart, direction = hypot(x, y), atan2(y, x)
            if first != last and apart < 2 * radius:
                continue
            line = apart if first == last else sqrt(apart**2 - 4 * radius**2)
            heading = direction if first == last else direction + first * atan2(2 * radius, line)
            turns = (first * heading % (2 * pi), last * (at["yaw_rad"] - heading) % (2 * pi))
            yield [(first / radius, radius * turns[0]), (0.0, line), (last / radius, radius * turns[1])]


def along(at, word):
    way = [at]
    for curvature, length in word:
        n = ceil(length / BOX_STEP_M)
        begin = way[-1]
        for k in range(1, n + 1):
            s = length * k / n
            turn = curvature * s
            x, y = (sin(turn) / curvature, (1 - cos(turn)) / curvature) if curvature else (s, 0.0)
            way.append(compose(begin, pose(x, y, turn)))
    return way


def fits(room, at, footprints, clearance):
    """Whether the footprints keep clear: points on them that are less than a cell apart, with what lies between."""
    clearance += sqrt(0.5) * room.resolution
    for footprint in footprints:
        centre = compose(at, footprint["pose"])
        nx, ny = (ceil(footprint[side] / room.resolution) for side in ("length_m", "width_m"))
        for i in range(nx + 1):
            for j in range(ny + 1):
                x, y = footprint["length_m"] * (i / nx - 0.5), footprint["width_m"] * (j / ny - 0.5)
                point = compose(centre, pose(x, y, 0.0))
                if not room.clear(point["x_m"], point["y_m"], clearance):
                    return False
    return True


def pose(x, y, yaw):
    return {"x_m": x, "y_m": y, "yaw_rad": atan2(sin(yaw), cos(yaw))}


def compose(a, b):
    c, s = cos(a["yaw_rad"]), sin(a["yaw_rad"])
    x, y = a["x_m"] + c * b["x_m"] - s * b["y_m"], a["y_m"] + s * b["x_m"] + c * b["y_m"]
    return pose(x, y, a["yaw_rad"] + b["yaw_rad"])


def inverse(a):
    c, s = cos(a["yaw_rad"]), sin(a["yaw_rad"])
    return pose(-c * a["x_m"] - s * a["y_m"], s * a["x_m"] - c * a["y_m"], -a["yaw_rad"])


def plan(status, reason, **fields):
    return {"status": status, "reason": reason, **fields}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", default="local")
    parser.add_argument("--name", default="main")
    parser.add_argument("--listen", nargs="*", default=["tcp/127.0.0.1:17471"])
    parser.add_argument("--connect", nargs="*", default=[])
    options = parser.parse_args()
    config = zenoh.Config()
    for key, value in {
        "mode": "peer",
        "listen/endpoints": options.listen,
        "connect/endpoints": options.connect,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "transport/shared_memory/enabled": False,
        "transport/link/tx/lease": 2000,
    }.items():
        config.insert_json5(key, json.dumps(value))
    prefix, incarnation = f"legpush/v{VERSION}/{options.run}", secrets.token_hex(6)
    inbox, answered, sequences = queue.Queue(), {}, {}

    def answer(request):
        header, request_id, query = request["header"], request["request_id"], request["query"]
        client, asker = header["name"], header["incarnation"]
        if (header["protocol"], header["run"]) != (VERSION, options.run):
            return
        last_asker, last_id, last_query, found = answered.get(client, (None, -1, None, None))
        if last_asker == asker and request_id < last_id:
            return
        if last_asker != asker or request_id != last_id:
            make = {"trunk_path": plan_trunk, "box_path": plan_box}.get(query["kind"])
            found = make(query) if make else plan("invalid", f"this planner knows no {query['kind']}")
            answered[client] = asker, request_id, query, found
        elif query != last_query:
            found = plan("invalid", f"request id {request_id} was used for another query before")
        sequences[client] = sequences.get(client, -1) + 1
        mine = {"protocol": VERSION, "run": options.run, "role": "planner", "name": options.name}
        result = {
            "header": {**mine, "incarnation": incarnation, "sequence": sequences[client]},
            "client_incarnation": asker,
            "request_id": request_id,
            "plan": found,
        }
        block, key = zenoh.CongestionControl.BLOCK, f"{prefix}/plan/{client}/result"
        session.put(key, msgpack.packb(result), congestion_control=block, express=True)

    with zenoh.open(config) as session:
        session.declare_subscriber(f"{prefix}/plan/*/request", lambda sample: inbox.put(sample.payload.to_bytes()))
        token = session.liveliness().declare_token(f"{prefix}/live/planner/{options.name}/{incarnation}")
        while token:
            payloads, newest = [inbox.get()], {}
            while not inbox.empty():
                payloads.append(inbox.get())
            for payload in payloads:  # of each client the last one counts
                with suppress(Exception):  # a message that is not valid harms nobody
                    request = msgpack.unpackb(payload)
                    newest[request["header"]["name"]] = request
            for request in newest.values():
                try:
                    answer(request)
                except Exception as error:
                    print(f"no answer to a request: {error!r}", file=sys.stderr)


if __name__ == "__main__":
    with suppress(KeyboardInterrupt):
        main()
