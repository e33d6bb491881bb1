"""Series of random pushes at a box on an open floor: what a response surface is fitted to."""

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from msgspec import Struct

from agent_proc.push_model.calibration import CalibrationError, open_floor
from legpush.errors import StopRequestedError
from legpush.geometry import Point3, Pose2
from legpush.lockstep.world import SteppingWorld
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Outcome, Push, Reset, WorldState
from legpush.scene.conventions import FRONT_LEGS, FrontLeg
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box
from legpush.scene.station import station

PUSHES_PER_SERIES: Final = 20
LEAST_DEPTH_M: Final = 0.003
DEEPEST_M: Final = 0.12


@dataclass(frozen=True, kw_only=True)
class RandomSeries:
    """Random pushes at a face, and the seed of these and of the place of the box."""

    face: Face
    seed: int

    def pushes(self) -> tuple[Push, ...]:
        """The pushes: leg, w1 and w2 are uniform; of the depth, half are uniform, and of half the logarithm is."""
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(0,)))
        return tuple(
            Push(
                leg=FRONT_LEGS[int(rng.integers(2))],
                w1=float(rng.uniform()),
                w2=float(rng.uniform()),
                depth_m=_depth_m(rng),
                face=self.face,
            )
            for _ in range(PUSHES_PER_SERIES)
        )


def _depth_m(rng: np.random.Generator) -> float:
    if rng.uniform() < 0.5:
        return float(rng.uniform(LEAST_DEPTH_M, DEEPEST_M))
    return float(np.exp(rng.uniform(*np.log([LEAST_DEPTH_M, DEEPEST_M]))))


class Stance(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the robot stands before or after a push."""

    trunk: Pose2
    """Pose of the trunk, projected to the floor, in the frame of the station."""
    trunk_height_m: float
    tips_m: tuple[Point3, Point3, Point3, Point3]
    """Centres of the foot spheres of FL, FR, RL, RR, in that projected frame."""
    joint_positions_rad: tuple[float, ...]


class MeasuredPush(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A push, its displacement of the pushed frame, and the robot after it."""

    leg: FrontLeg
    w1: float
    w2: float
    depth_m: float
    forward_m: float
    left_m: float
    turn_rad: float
    n_ticks: int
    n_footsteps: int
    peak_force_n: float
    after: Stance


class MeasuredSeries(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A series that was carried out."""

    face: Face
    before: Stance
    """After the reset."""
    pushes: tuple[MeasuredPush, ...]


def measure_series(
    world: SteppingWorld, robot: RobotSpec, box: Box, series: RandomSeries, stop: threading.Event | None = None
) -> MeasuredSeries:
    """Carry out a series.

    Raises:
        CalibrationError: The robot fell.
        StopRequestedError: `stop` was set; checked before each push.
    """
    face = series.face
    outcome = world.step(Reset(scenario=open_floor(robot, box, face), seed=series.seed))
    before = _stance(outcome.world, robot, box, face)
    measured = []
    for push in series.pushes():
        if stop is not None and stop.is_set():
            raise StopRequestedError("Asked to stop in a calibration")
        last, outcome = outcome, world.step(push)
        if outcome.world.fallen:
            raise CalibrationError(f"The robot fell as it pushed the {face} face {push.depth_m} m deep, {push.leg}")
        measured.append(_measured(last, push, outcome, robot, box))
    return MeasuredSeries(face=face, before=before, pushes=tuple(measured))


def displacement(before: WorldState, push: Push, after: WorldState) -> Pose2:
    """Displacement of the pushed frame by a push, in that frame before it."""
    from_, to = (pushed_pose(planar_pose(world.box), push.face) for world in (before, after))
    return from_.inverse() @ to


def _measured(last: Outcome, push: Push, outcome: Outcome, robot: RobotSpec, box: Box) -> MeasuredPush:
    moved = displacement(last.world, push, outcome.world)
    return MeasuredPush(
        leg=push.leg,
        w1=push.w1,
        w2=push.w2,
        depth_m=push.depth_m,
        forward_m=moved.x_m,
        left_m=moved.y_m,
        turn_rad=moved.yaw_rad,
        n_ticks=outcome.world.tick - last.world.tick,
        n_footsteps=outcome.world.n_footsteps - last.world.n_footsteps,
        peak_force_n=0.0 if outcome.world.push is None else outcome.world.push.peak_force_n,
        after=_stance(outcome.world, robot, box, push.face),
    )


def _stance(world: WorldState, robot: RobotSpec, box: Box, face: Face) -> Stance:
    trunk = planar_pose(world.trunk)
    place = station(robot, pushed_box(box, face), pushed_pose(planar_pose(world.box), face))
    tips_m = trunk.inverse().apply([tip[:2] for tip in world.tips_m]).tolist()
    fl, fr, rl, rr = ((x, y, tip[2]) for (x, y), tip in zip(tips_m, world.tips_m, strict=True))
    return Stance(
        trunk=place.inverse() @ trunk,
        trunk_height_m=world.trunk.position_m[2],
        tips_m=(fl, fr, rl, rr),
        joint_positions_rad=world.joint_positions_rad,
    )


def mean_stance(stances: Sequence[Stance]) -> Stance:
    """The mean of each number; the headings have to be near 0."""
    rows = np.array(
        [
            (
                s.trunk.x_m,
                s.trunk.y_m,
                s.trunk.yaw_rad,
                s.trunk_height_m,
                *(c for tip in s.tips_m for c in tip),
                *s.joint_positions_rad,
            )
            for s in stances
        ]
    )
    x, y, yaw, height, *rest = rows.mean(axis=0).round(6).tolist()
    fl, fr, rl, rr = ((rest[k], rest[k + 1], rest[k + 2]) for k in range(0, 12, 3))
    return Stance(
        trunk=Pose2(x_m=x, y_m=y, yaw_rad=yaw),
        trunk_height_m=height,
        tips_m=(fl, fr, rl, rr),
        joint_positions_rad=tuple(rest[12:]),
    )
