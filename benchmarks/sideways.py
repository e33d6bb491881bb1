"""`python -m benchmarks.sideways`: which strides hold when the robot walks in another direction than it heads.

It walks 3 m on an open floor, in each direction with each stride and with the one that the gait chooses by itself. The
numbers go to `results/sideways.json`.
"""

from dataclasses import dataclass
from math import cos, degrees, radians, sin
from typing import Final

import numpy as np
import tyro

from benchmarks.report import write_report
from legpush.geometry import Pose2
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Follow, Reset, Walk
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from sim_proc.control import footsteps
from sim_proc.simulator import Simulator

DIRECTIONS_DEG: Final = (0, 30, 45, 60, 75, 90, 105, 120, 135, 150, 165, 180)
STRIDES_M: Final = (0.4, 0.3, 0.25, 0.2, 0.15)
LENGTH_M: Final = 3.0
SPACING_M: Final = 0.05
ROOM_M: Final = 12.0


@dataclass(frozen=True, kw_only=True)
class Config:
    """How often to walk."""

    seeds: int = 3
    """Number of walks of each direction and stride, each with another heading in the room and another length."""


@dataclass(frozen=True)
class Walked:
    """A walk."""

    fell: bool
    margin_m: float
    """Least distance of the CoM from the border of the support polygon; negative outside."""
    tilt_deg: float
    """Largest roll or pitch of the trunk."""


def main(config: Config) -> None:
    """Walk in every direction, and report the strides."""
    chosen, usual = footsteps.STRIDE_SHARES, RobotSpec()
    directions = {}
    for direction_deg in DIRECTIONS_DEG:
        by_stride = {"chosen": _summary([_walk(direction_deg, seed) for seed in range(config.seeds)])}
        for stride_m in STRIDES_M:
            share = stride_m / usual.gait.stride_m
            vars(footsteps)["STRIDE_SHARES"] = ((0.0, share), (180.0, share))
            by_stride[f"{stride_m:g}"] = _summary([_walk(direction_deg, seed) for seed in range(config.seeds)])
        vars(footsteps)["STRIDE_SHARES"] = chosen
        ahead = np.array([[cos(radians(direction_deg)), sin(radians(direction_deg)), 0.0]])
        stride_m = float(footsteps.longest_stride_m(usual.gait, ahead, 0.0)[0])
        directions[f"{direction_deg}"] = {"stride_m": round(stride_m, 3), **by_stride}
    write_report("sideways", {"n": config.seeds, "length_m": LENGTH_M, "directions": directions})


def _walk(direction_deg: float, seed: int) -> Walked:
    """Walk straight on, with an unchanged heading."""
    random = np.random.default_rng(seed)
    start = PoseDeg(x_m=ROOM_M / 2, y_m=ROOM_M / 2, yaw_deg=float(random.uniform(-180.0, 180.0)))
    corner = PoseDeg(x_m=1.0, y_m=1.0, yaw_deg=0.0)
    scenario = Scenario(
        name="sideways",
        room=Room(size_m=(ROOM_M, ROOM_M)),
        start=start,
        box=Box(pose=corner),
        goal=Goal(pose=corner),
    )
    length_m = LENGTH_M + float(random.uniform(0.0, 0.2))
    along = start.pose().yaw_rad + radians(direction_deg)
    waypoints = tuple(
        Pose2(x_m=start.x_m + at_m * cos(along), y_m=start.y_m + at_m * sin(along), yaw_rad=start.pose().yaw_rad)
        for at_m in np.append(np.arange(0.0, length_m, SPACING_M), length_m).tolist()
    )
    world = LocalWorld(Simulator())
    world.step(Reset(scenario=scenario, seed=seed))
    outcome = world.step(Follow(waypoints=waypoints))
    margin_m, tilt_rad = np.inf, 0.0
    while outcome.world.path is not None and not (outcome.world.fallen or outcome.world.path.done):
        outcome = world.step(Walk(), with_trace=True)
        if outcome.trace is not None:
            margin_m = min(margin_m, *outcome.trace.support_margin_m)
            tilt_rad = max(tilt_rad, float(np.abs(outcome.trace.roll_pitch_rad).max()))
    return Walked(outcome.world.fallen, float(margin_m), degrees(tilt_rad))


def _summary(walks: list[Walked]) -> dict[str, float]:
    return {
        "n_falls": sum(walk.fell for walk in walks),
        "least_margin_m": round(min(walk.margin_m for walk in walks), 4),
        "largest_tilt_deg": round(max(walk.tilt_deg for walk in walks), 2),
    }


if __name__ == "__main__":
    main(tyro.cli(Config))
