"""Paths of the box for grid_planner.py: an arc, a line and an arc, pushed from the same side all the way.

A point is a complex number, x + iy, and a heading is one of length 1: adding moves, multiplying turns. A place is a
pair of both.
"""

from cmath import phase, rect
from itertools import product
from math import ceil, hypot, sqrt, tau

STEP_M = 0.025  # between two places of a path


def plan_box(query, fits):
    """Return a plan with the shortest path of one side on which the discs around box and robot touch nothing.

    `fits` tests a disc. The straight run-in before the goal is left out only if that saves more than its length.
    """
    if is_at_goal(query):
        side = query["present_side"] or 0
        return {"status": "exact", "reason": "", "waypoints": [query["start"]], "sides": [side], "length_m": 0.0}
    paths = []
    for (index, side), run_in_m in product(enumerate(query["sides"]), (query["run_in_m"], 0.0)):
        begin, end = (moved(place(query[name]), place(side["frame"])) for name in ("start", "goal"))
        for parts in arcs_and_lines(begin, moved(end, (-run_in_m, 1.0)), side["min_turning_radius_m"]):
            length_m = sum(part_m for _, part_m in parts)
            walk_m = query["side_change_m"] * (index != query["present_side"])
            paths.append((length_m + walk_m, length_m + run_in_m, index, [begin], [*parts, (0.0, run_in_m)]))
    for _, length_m, index, way, parts in sorted(paths, key=lambda path: path[0]):
        side = query["sides"][index]
        for curvature, part_m in parts:
            way += driven(way[-1], curvature, part_m)
        if all(is_clear(query, fits, side["footprints"], at) for at in way):
            frame, frame_heading = place(side["frame"])
            box_from_side = -frame / frame_heading, 1.0 / frame_heading
            boxes = [pose(*moved(at, box_from_side)) for at in way]
            sides = [index] * len(boxes)
            return {"status": "exact", "reason": "", "waypoints": boxes, "sides": sides, "length_m": length_m}
    return {"status": "failed", "reason": "no arc, line and arc from one side keep clear; no other paths are tried"}


def is_at_goal(query):
    """Whether the box is within the tolerances of its goal, so that it need not move."""
    (start, heading), (goal, goal_heading) = place(query["start"]), place(query["goal"])
    off_rad = abs(phase(heading / goal_heading))
    return abs(goal - start) <= query["position_tolerance_m"] and off_rad <= query["angle_tolerance_rad"]


def arcs_and_lines(begin, end, radius_m):
    """Yield the Dubins paths that are an arc, a line and an arc; each part is (curvature, length)."""
    (start, start_heading), (goal, goal_heading) = begin, end
    for first, last in product((1, -1), repeat=2):  # 1 turns left, -1 turns right
        apart = goal + 1j * last * radius_m * goal_heading - start - 1j * first * radius_m * start_heading
        across_m = (last - first) * radius_m
        if abs(apart) > abs(across_m):
            line_m = sqrt(abs(apart) ** 2 - across_m**2)  # a tangent of both circles
            heading = apart / complex(line_m, across_m)
            turns = first * phase(heading / start_heading), last * phase(goal_heading / heading)
            arcs_m = [radius_m * max(0.0, (turn + 1e-9) % tau - 1e-9) for turn in turns]  # no full turn by rounding
            yield [(first / radius_m, arcs_m[0]), (0.0, line_m), (last / radius_m, arcs_m[1])]


def driven(begin, curvature, length_m):
    """Yield places along an arc or a line, without the first."""
    n = ceil(length_m / STEP_M)
    for at_m in [length_m * k / n for k in range(1, n + 1)]:
        turn = rect(1.0, curvature * at_m)
        yield moved(begin, (at_m if curvature == 0.0 else (turn - 1.0) / (1j * curvature), turn))


def is_clear(query, fits, footprints, at):
    """Whether the discs around the footprints keep the clearance, and one step more for the stretch to the next
    place."""
    for footprint in footprints:
        centre, _ = moved(at, place(footprint["pose"]))
        radius_m = hypot(footprint["length_m"], footprint["width_m"]) / 2
        if not fits(query["grid"], centre, radius_m + query["clearance_m"] + STEP_M):
            return False
    return True


def place(pose):
    return complex(pose["x_m"], pose["y_m"]), rect(1.0, pose["yaw_rad"])


def moved(frame, at):
    """Return the place in the world of a place that is given in a frame."""
    return frame[0] + frame[1] * at[0], frame[1] * at[1]


def pose(point, heading):
    return {"x_m": point.real, "y_m": point.imag, "yaw_rad": phase(heading)}
