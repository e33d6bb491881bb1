"""Calibration: series of pushes at a box on an open floor, and the displacement by each push."""

import threading
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import degrees
from queue import SimpleQueue
from typing import Final, TypeVar

from msgspec.structs import replace

from agent_proc.push_model.map import Sample
from legpush.errors import LegpushError, StopRequestedError
from legpush.geometry import Pose2
from legpush.lockstep.world import SteppingWorld
from legpush.long_work.parallel import in_parallel
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Outcome, Push, Reset
from legpush.realism.settings import Randomization
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.faces import TURN_RAD, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from legpush.scene.station import station

Part = TypeVar("Part", bound=Hashable)
Measured = TypeVar("Measured")
SERIES: Final = (0, 1, 0, 0, 1, 1, 0, 1)
"""0 is a push with FL, 1 with FR: each leg pushes four times, after itself as well as after the other one."""
FLOOR_M: Final = (6.0, 4.0)


class CalibrationError(LegpushError):
    """The box cannot be measured, because the robot fell."""

    exit_code = 1


@dataclass(frozen=True, kw_only=True)
class Cell:
    """Pushes that differ in the leg only, and the seed that the place of their box is drawn from."""

    face: Face
    curve: tuple[float, float]
    depth_m: float
    seed: int


def cells(
    faces: Sequence[Face], curves: Sequence[tuple[float, float]], depths_m: Sequence[float], seeds: Sequence[int]
) -> list[Cell]:
    """All combinations of face, curve, depth and seed."""
    return [Cell(face=f, curve=c, depth_m=d, seed=s) for f, c, d, s in product(faces, curves, depths_m, seeds)]


def open_floor(robot: RobotSpec, box: Box, face: Face) -> Scenario:
    """A scenario with the robot at its station behind the face; the box is turned so that a push moves it along x."""
    pose = PoseDeg(x_m=FLOOR_M[0] / 3, y_m=FLOOR_M[1] / 2, yaw_deg=-degrees(TURN_RAD[face]))
    place = station(robot, pushed_box(box, face), pushed_pose(pose.pose(), face))
    return Scenario(
        name="calibration",
        room=Room(size_m=FLOOR_M),
        start=PoseDeg(x_m=place.x_m, y_m=place.y_m, yaw_deg=0.0),
        box=replace(box, pose=pose),
        goal=Goal(pose=replace(pose, x_m=pose.x_m + 1.0)),
        randomization=Randomization(box_xy_m=0.02, box_yaw_deg=3.0),
        robot=robot,
    )


def push_series(world: SteppingWorld, scenario: Scenario, cell: Cell) -> Iterator[tuple[Push, Pose2, Outcome]]:
    """Push the box again and again; yields each push, the displacement of the pushed frame, and the outcome.

    The displacement is expressed in the frame before the push.

    Raises:
        CalibrationError: The robot fell.
    """
    before = pushed_pose(planar_pose(world.step(Reset(scenario=scenario, seed=cell.seed)).world.box), cell.face)
    w1, w2 = cell.curve
    for index in SERIES:
        push = Push(w1=w1, w2=w2, leg=FRONT_LEGS[index], depth_m=cell.depth_m, face=cell.face)
        outcome = world.step(push, with_trace=True)
        if outcome.world.fallen:
            raise CalibrationError(
                f"The robot fell as it pushed the {cell.face} face {cell.depth_m} m deep, {push.leg}"
            )
        after = pushed_pose(planar_pose(outcome.world.box), cell.face)
        yield push, before.inverse() @ after, outcome
        before = after


def in_worlds(
    worlds: Sequence[SteppingWorld],
    planned: Sequence[Part],
    measure: Callable[[SteppingWorld, Part], Measured],
    on_part: Callable[[Part, Measured], None],
    finished: Mapping[Part, Measured] | None = None,
) -> list[Measured]:
    """Measure every part that is not `finished`, one per world at a time; results of all in the order of the parts.

    `on_part` is called on the caller's thread with each part as it is measured.
    """
    free: SimpleQueue[SteppingWorld] = SimpleQueue()
    for world in worlds:
        free.put(world)

    def one(part: Part) -> tuple[Part, Measured]:
        world = free.get()
        try:
            return part, measure(world, part)
        finally:
            free.put(world)

    measured = dict(finished or {})
    missing = [part for part in planned if part not in measured]
    measured |= in_parallel([partial(one, part) for part in missing], len(worlds), lambda made: on_part(*made))
    return [measured[part] for part in planned]


def cell_samples(
    world: SteppingWorld, robot: RobotSpec, box: Box, cell: Cell, stop: threading.Event | None = None
) -> list[Sample]:
    """Measure the pushes of a cell.

    Raises:
        StopRequestedError: `stop` was set; checked before each push.
        CalibrationError: The robot fell.
    """
    found = []
    for push, moved, _ in push_series(world, open_floor(robot, box, cell.face), cell):
        if stop is not None and stop.is_set():
            raise StopRequestedError("Asked to stop in a calibration")
        found.append(
            Sample(
                face=cell.face,
                leg=push.leg,
                w1=push.w1,
                w2=push.w2,
                depth_m=cell.depth_m,
                forward_m=moved.x_m,
                left_m=moved.y_m,
                turn_rad=moved.yaw_rad,
            )
        )
    return found
