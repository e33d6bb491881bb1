"""Ways to push the box from one pose to another, from one side or from two: their cost, and whether they fit."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import cos, hypot, sin
from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.geometry import Pose2, distance_m, wrap_angle
from legpush.messages.planning import BoxPathQuery, PushSide
from legpush.scene.footprints import Footprint
from planner_proc.box.body_walks import BodyWalks
from planner_proc.box.dubins import SAMPLE_M, Dubins
from planner_proc.box.walking_space import WalkingSpace, places_behind
from planner_proc.clearance.field import ClearanceField
from planner_proc.clearance.footprint_field import FootprintField, Squares, placed

LEAST_STAGE_M: Final = 0.005
"""Shortest stage for which it is worth changing sides."""
STEPS_BACK_M: Final = (0.0, 0.1, 0.2, 0.3, 0.4)
"""How far behind its stand-off the robot may step back before it walks to another side."""


@dataclass(frozen=True, kw_only=True)
class Stage:
    """The shortest push from one pose of the box to another, from one side."""

    side: int
    begin: Pose2
    end: Pose2
    length_m: float


NEAR_M: Final = 0.15
NEAR_RAD: Final = 0.25
"""Poses of the box that differ by less are the same place to walk around."""

Way = tuple[Stage, ...]
"""Stages in order: each begins where the one before it ends."""


class Side:
    """A face of the box that can be pushed: its pushes, and whether box and robot fit in the room."""

    def __init__(self, side: PushSide, query: BoxPathQuery, field: ClearanceField, squares: Squares) -> None:
        """Take `field` and `squares` of the query's grid."""
        self._field = field
        self._walk_clearance_m = query.walk_clearance_m
        self._stand_off = side.frame @ side.stand_off
        self._body = None if query.body is None else FootprintField((query.body,), field, squares)
        self._body_clearance_m = query.body_clearance_m
        self._frame = side.frame
        self._box_from_frame = side.frame.inverse()
        self.turn_rad = side.frame.yaw_rad
        self._dubins = Dubins(side.min_turning_radius_m)
        self.footprints = FootprintField(side.footprints, field, squares)
        self.required_m = _required_m(query.clearance_m, self.footprints.reach_m, side.min_turning_radius_m)

    def length_m(self, a: Pose2, b: Pose2) -> float:
        """Length of the push from one pose of the box to another."""
        return self._dubins.length_m(a @ self._frame, b @ self._frame)

    def along(self, a: Pose2, b: Pose2, distance_m: float) -> Pose2:
        """Pose of the box at a distance along the push from one pose to another."""
        return self._dubins.along(a @ self._frame, b @ self._frame, distance_m) @ self._box_from_frame

    def ahead(self, pose: Pose2, distance_m: float) -> Pose2:
        """Pose of the box after a straight push by a distance; before one, if it is negative."""
        yaw_rad = pose.yaw_rad + self.turn_rad
        return Pose2(
            x_m=pose.x_m + distance_m * cos(yaw_rad), y_m=pose.y_m + distance_m * sin(yaw_rad), yaw_rad=pose.yaw_rad
        )

    def pushed(self, stage: Stage) -> Floats:
        """Poses of the pushed frame along a stage, (n, 3)."""
        return self._dubins.poses(stage.begin @ self._frame, stage.end @ self._frame)

    def box(self, pushed: Floats) -> Floats:
        """Poses of the box for poses of the pushed frame, (n, 3)."""
        return placed(pushed, self._box_from_frame)

    def seems_free(self, stage: Stage, extra_m: float) -> bool:
        """Whether box and robot fit all along a stage, by the quick measure, with `extra_m` more than is required."""
        return self.footprints.seems_free(self.pushed(stage), self.required_m + extra_m)

    def can_begin(self, pose: Pose2) -> bool:
        """Whether the robot can come to stand behind the box at a pose, and push from there."""
        stand_off = self.stand_off(pose)
        room_m = self._field.clearance_m(stand_off.xy()[None])[0]
        if room_m < self._walk_clearance_m or not self.fits(pose):
            return False
        return self._body is None or bool(self._body.free(_row(stand_off), self._body_clearance_m)[0])

    def stand_off(self, pose: Pose2) -> Pose2:
        """Where the robot's walk to this side ends if the box is at a pose."""
        return pose @ self._stand_off

    def fits(self, pose: Pose2) -> bool:
        """Whether box and robot fit, exactly, if the box is at a pose."""
        return bool(self.footprints.free(_row(pose @ self._frame), self.required_m)[0])


class Pushes:
    """All pushes that a query allows, from all of its sides."""

    def __init__(self, query: BoxPathQuery, field: ClearanceField) -> None:
        """Take the `field` of the query's grid."""
        squares = Squares(query.grid)
        self.sides = [Side(side, query, field, squares) for side in query.sides]
        self._field = field
        self._query = query
        self.extra_m = 0.0
        """Clearance to keep beyond what is required, by the quick measure."""
        self._no_walks: list[tuple[int, Stage]] = []
        """Sides with the stages to whose beginnings no walk of the body leads from them."""
        self.out_of_reach = False
        """Whether a way was refused because the robot cannot come to a side where box and robot fit."""

    def cost_m(self, way: Sequence[Stage], side_before: int | None) -> float:
        """Length, plus the cost of each change of sides, that from `side_before` to the first stage included."""
        sides = [side_before, *(stage.side for stage in way)]
        n_changes = sum(a != b for a, b in pairwise(sides))
        return sum(stage.length_m for stage in way) + self._query.side_change_m * n_changes

    def stage(self, side: int, begin: Pose2, end: Pose2) -> Stage:
        """The shortest push from a side."""
        return Stage(side=side, begin=begin, end=end, length_m=self.sides[side].length_m(begin, end))

    def free(self, way: Sequence[Stage], side_before: int | None) -> bool:
        """Whether box and robot fit all along, by the quick measure, and the robot can walk to each other side."""
        sides = [side_before, *(stage.side for stage in way)]
        changes = [(stage, before) for stage, before in zip(way, sides, strict=False) if stage.side != before]
        if not all(self.sides[stage.side].can_begin(stage.begin) for stage, _ in changes):
            if not self.out_of_reach:
                self.out_of_reach = any(self.sides[stage.side].fits(stage.begin) for stage, _ in changes)
            return False
        if not all(self.sides[stage.side].seems_free(stage, self.extra_m) for stage in way):
            return False
        can_walk = all(self._can_walk(before, stage) for stage, before in changes if before is not None)
        self.out_of_reach |= not can_walk
        return can_walk

    @cached_property
    def _walking(self) -> WalkingSpace:
        """Made at the first change of sides, because many paths have none."""
        return WalkingSpace(self._query.grid, self._field, self._query.walk_clearance_m)

    def _can_walk(self, before: int, stage: Stage) -> bool:
        """Whether the robot can walk around the box, from one of its sides to where a stage begins."""
        if any(before == side and _are_near(stage, other) for side, other in self._no_walks):
            return False
        begins_m = places_behind(self.sides[before].stand_off(stage.begin), STEPS_BACK_M)[:, :2]
        end_m = self.sides[stage.side].stand_off(stage.begin).xy()
        return self._walking.joins(begins_m, end_m, self._box(stage))

    def _box(self, stage: Stage) -> Footprint:
        """The box where a stage begins."""
        return replace(self._query.box, pose=stage.begin @ self._query.box.pose)

    def body_can_walk(self, way: Sequence[Stage]) -> bool:
        """Whether the body of the robot, too, can walk to each other side; what it cannot is refused from now on."""
        query = self._query
        for stage, following in pairwise(way):
            if query.body is None or stage.side == following.side:
                continue
            begins = places_behind(self.sides[stage.side].stand_off(following.begin), STEPS_BACK_M)
            end = _row(self.sides[following.side].stand_off(following.begin))[0]
            clearances_m = (query.walk_clearance_m, query.body_clearance_m)
            if not BodyWalks(query.grid, self._box(following), query.body, *clearances_m).joins(begins, end):
                self._no_walks.append((stage.side, following))
                self.out_of_reach = True
                return False
        return True

    def one_side(self, a: Pose2, b: Pose2) -> Iterator[Way]:
        """The direct push from each side."""
        for index in range(len(self.sides)):
            yield (self.stage(index, a, b),)

    def to_goal(self, a: Pose2, goal: Pose2) -> Iterator[Way]:
        """Ways into the goal: from one side, straight at the end, or from two sides, one of the two stages straight."""
        for index, side in enumerate(self.sides):
            before = side.ahead(goal, -self._query.run_in_m)
            yield (self.stage(index, a, before), self.stage(index, before, goal))
            straight = self.stage(index, a, goal)
            if straight.length_m <= self._query.run_in_m:
                yield (straight,)
            near = self._near_goal(side, a, goal)
            if near is not None:
                yield (self.stage(index, a, near),)
        yield from self.two_sides(a, goal)

    def _near_goal(self, side: Side, a: Pose2, goal: Pose2) -> Pose2 | None:
        """Where a straight push from `a` comes nearest to the goal; None if that is beyond its tolerances."""
        yaw_rad = a.yaw_rad + side.turn_rad
        end = side.ahead(a, (goal.x_m - a.x_m) * cos(yaw_rad) + (goal.y_m - a.y_m) * sin(yaw_rad))
        query = self._query
        ahead = (end.x_m - a.x_m) * cos(yaw_rad) + (end.y_m - a.y_m) * sin(yaw_rad) > 0.0
        near = hypot(end.x_m - goal.x_m, end.y_m - goal.y_m) <= query.position_tolerance_m
        aligned = abs(wrap_angle(a.yaw_rad - goal.yaw_rad)) <= query.angle_tolerance_rad
        return end if ahead and near and aligned else None

    def two_sides(self, a: Pose2, b: Pose2) -> Iterator[Way]:
        """Ways with one straight stage, as long as the box has to move in its direction, and one from another side."""
        for index, side in enumerate(self.sides):
            for at_end in (True, False):
                yaw_rad = (b if at_end else a).yaw_rad + side.turn_rad
                distance_m = (b.x_m - a.x_m) * cos(yaw_rad) + (b.y_m - a.y_m) * sin(yaw_rad)
                if distance_m < LEAST_STAGE_M:
                    continue
                middle = side.ahead(b, -distance_m) if at_end else side.ahead(a, distance_m)
                for other in range(len(self.sides)):
                    if other != index:
                        order = (other, index) if at_end else (index, other)
                        way = (self.stage(order[0], a, middle), self.stage(order[1], middle, b))
                        if min(stage.length_m for stage in way) >= LEAST_STAGE_M:
                            yield way

    def best(self, ways: Iterator[Way], side_before: int | None, below_m: float, n_tried: int) -> Way | None:
        """The cheapest way that is free and costs less than `below_m`; only the `n_tried` cheapest ways are tried."""
        costed = sorted(((self.cost_m(way, side_before), k, way) for k, way in enumerate(ways)), key=lambda c: c[:2])
        for cost_m, _, way in costed[:n_tried]:
            if cost_m >= below_m:
                break
            if self.free(way, side_before):
                return way
        return None


def _required_m(clearance_m: float, reach_m: float, radius_m: float) -> float:
    """Clearance at samples that are `SAMPLE_M` apart with which footprints keep `clearance_m` between them, too.

    Seen from a footprint, a point of an obstacle moves along an arc of at most length 2 h between two samples. If a
    straight line of that length comes as near as c to a convex shape, one of its ends is no farther from it than the
    root of c² + h². The arc is off its chord by less than the last term.
    """
    half_m = 0.5 * SAMPLE_M * (1.0 + reach_m / radius_m)
    off_m = (radius_m + reach_m) * (SAMPLE_M / radius_m) ** 2 / 8
    return hypot(clearance_m, half_m) + off_m


def _are_near(a: Stage, b: Stage) -> bool:
    """Whether two stages begin at the same side and nearly the same pose."""
    off_rad = abs(wrap_angle(a.begin.yaw_rad - b.begin.yaw_rad))
    return a.side == b.side and distance_m(a.begin, b.begin) < NEAR_M and off_rad < NEAR_RAD


def _row(pose: Pose2) -> Floats:
    """A pose as an array, (1, 3)."""
    return np.array([[pose.x_m, pose.y_m, pose.yaw_rad]])
