"""Walks and pushes for benchmarks of the robot, and what was measured of them at every physics step."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot
from typing import Any, Final

import numpy as np
from msgspec.structs import replace

from legpush.errors import MotionError
from legpush.geometry import Pose2
from legpush.lockstep.local import LocalWorld
from legpush.messages.measures import Measures, merged, torque_quantiles
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Outcome, Push, Reset, Walk
from legpush.realism.settings import Realism
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import CONTROL_PERIOD_S, FRONT_LEGS
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from sim_proc.simulator import Simulator

ROOM_M: Final = 16.0
START_M: Final = 5.0
"""Where a straight walk begins, along the room."""
MAX_CYCLES: Final = 60
"""A walk of more gait cycles does not arrive."""
LENGTHS_M: Final = (4.0, 6.0)
"""Shortest and longest walk."""
BENDS_RAD: Final = 0.9
"""Largest heading of a curved walk from its first heading."""
SPACING_M: Final = 0.05
AS_IT_IS: Final = Realism()
"""The world is what the robot takes it to be."""
PUSH_DEPTHS_M: Final = (0.02, 0.08)
TORQUE_SHARE: Final = 0.999
LANDING_PERCENT: Final = 99.0


@dataclass(frozen=True, kw_only=True)
class Done:
    """What came of some motions of one robot."""

    fell: bool
    stopped: bool
    """Whether it did not fall, but a walk ended before its path."""
    measures: Measures | None
    """Of all motions; None if nothing moved."""
    duration_s: float
    """Simulated time of the motions."""
    way_m: float
    """Length of the walked path, or the way of the box."""
    error_m: float
    """From the end of the path to the trunk, or how far the box went to the side."""


def curved_walk(seed: int, robot: RobotSpec | None = None, realism: Realism = AS_IT_IS) -> Done:
    """Walk along a curve of 4 to 6 m on an open floor."""
    random = np.random.default_rng(seed)
    heading = float(random.uniform(-np.pi, np.pi))
    length_m = float(random.uniform(*LENGTHS_M))
    at_m = np.append(np.arange(0.0, length_m, SPACING_M), length_m)
    bend, turns = float(random.uniform(-BENDS_RAD, BENDS_RAD)), float(random.uniform(0.5, 1.5))
    yaw = heading + bend * np.sin(np.pi * turns * at_m / length_m)
    step_m = np.diff(at_m, prepend=0.0)
    x_m, y_m = (ROOM_M / 2 + np.cumsum(step_m * along) for along in (np.cos(yaw), np.sin(yaw)))
    path = [Pose2(x_m=x, y_m=y, yaw_rad=a) for x, y, a in np.stack([x_m, y_m, yaw], axis=1).tolist()]
    return _walked(path, heading, seed, robot, realism, length_m)


def straight_walk(length_m: float, robot: RobotSpec | None = None, realism: Realism = AS_IT_IS) -> Done:
    """Walk straight ahead on an open floor."""
    at_m = np.append(np.arange(0.0, length_m, SPACING_M), length_m).tolist()
    path = [Pose2(x_m=START_M + x, y_m=ROOM_M / 2, yaw_rad=0.0) for x in at_m]
    return _walked(path, 0.0, 0, robot, realism, length_m)


def _walked(
    path: Sequence[Pose2], heading_rad: float, seed: int, robot: RobotSpec | None, realism: Realism, length_m: float
) -> Done:
    start = PoseDeg(x_m=path[0].x_m, y_m=path[0].y_m, yaw_deg=float(np.degrees(heading_rad)))
    corner = PoseDeg(x_m=1.0, y_m=1.0, yaw_deg=0.0)
    scenario = Scenario(
        name="walk",
        room=Room(size_m=(ROOM_M, ROOM_M)),
        start=start,
        box=Box(pose=corner),
        goal=Goal(pose=corner),
        robot=robot or RobotSpec(),
        realism=realism,
    )
    world = LocalWorld(Simulator())
    began = world.step(Reset(scenario=scenario, seed=seed))
    outcomes = [world.step(Follow(waypoints=tuple(path)))]
    while _goes_on(outcomes[-1]) and len(outcomes) < MAX_CYCLES + 1:
        try:
            outcomes.append(world.step(Walk()))
        except MotionError:  # a foot found no floor
            break
    trunk = planar_pose(outcomes[-1].world.trunk)
    return _done(began, outcomes, length_m, hypot(trunk.x_m - path[-1].x_m, trunk.y_m - path[-1].y_m))


def pushes(seed: int, mass_kg: float, n: int = 4, robot: RobotSpec | None = None, realism: Realism = AS_IT_IS) -> Done:
    """Push a box of the scenario `push` with both legs in turn; w1, w2 and depth are drawn."""
    random = np.random.default_rng(seed)
    usual = load_scenario("push")
    box = replace(usual.box, mass_kg=mass_kg)
    world = LocalWorld(Simulator())
    scenario = replace(usual, box=box, robot=robot or RobotSpec(), realism=realism)
    began = world.step(Reset(scenario=scenario, seed=seed))
    outcomes = []
    for index in range(n):
        w1, w2 = random.uniform(size=2).tolist()
        depth_m = float(random.uniform(*PUSH_DEPTHS_M))
        try:
            outcomes.append(world.step(Push(w1=w1, w2=w2, leg=FRONT_LEGS[index % 2], depth_m=depth_m)))
        except MotionError:  # the box has left the robot's station
            break
        if outcomes[-1].world.fallen:
            break
    last = outcomes[-1] if outcomes else began
    moved = planar_pose(began.world.box).inverse() @ planar_pose(last.world.box)
    return _done(began, outcomes, moved.x_m, abs(moved.y_m))


def summary(runs: Sequence[Done]) -> dict[str, Any]:
    """Return the numbers of several runs: extremes over all of them, and means of ways and errors.

    What nothing was measured of is None, such as touchdowns if every run fell before its first footstep.
    """
    measures = merged(run.measures for run in runs if run.measures is not None)
    if measures is None:
        raise ValueError("Expected motions, got none")
    peaks = [joint.max_torque_n_m for joint in RobotSpec().joints.in_order()]
    by_kind = np.array(measures.max_torques_n_m).reshape(4, 3)
    shares = torque_quantiles(measures, TORQUE_SHARE)
    landings = np.array(measures.landing_speeds_m_s)
    n_footsteps = measures.n_footsteps or None
    return {
        "n": len(runs),
        "n_falls": sum(run.fell for run in runs),
        "n_stopped": sum(run.stopped for run in runs),
        "speed_m_s": _round(sum(run.way_m for run in runs) / sum(run.duration_s for run in runs)),
        "way_m": _round(np.mean([run.way_m for run in runs])),
        "error_m": _round(np.mean([run.error_m for run in runs])),
        "max_torques_n_m": [_round(value, 1) for value in by_kind.max(axis=0)],
        "torques_999_n_m": [_round(share * peak, 1) for share, peak in zip(shares, peaks, strict=True)],
        "max_speeds_rad_s": [
            _round(value, 2) for value in np.array(measures.max_speeds_rad_s).reshape(4, 3).max(axis=0)
        ],
        "touchdowns_per_footstep": n_footsteps and _round(measures.n_touchdowns / n_footsteps),
        "loadings_per_footstep": n_footsteps and _round(measures.n_loadings / n_footsteps),
        "n_landings": len(landings),
        "landing_speed_99_m_s": _round(np.percentile(landings, LANDING_PERCENT)) if landings.size else None,
        "landing_speed_max_m_s": _round(landings.max()) if landings.size else None,
        "penetration_m": _round(measures.max_penetration_m, 5),
        "n_steps": measures.n_steps,
        "n_outside_support": measures.n_outside_support,
        "min_support_margin_m": _round(measures.min_support_margin_m, 4),
        "min_zmp_margin_m": _round(measures.min_zmp_margin_m, 4),
        "min_capture_margin_m": _round(measures.min_capture_margin_m, 4),
        "n_unexpected_steps": measures.n_unexpected_steps,
        "unexpected": [f"{each.first} {each.second}" for each in measures.unexpected],
        "positive_work_j_per_m": _round(measures.positive_work_j / max(sum(run.way_m for run in runs), 1e-9), 1),
    }


def _done(began: Outcome, outcomes: Sequence[Outcome], way_m: float, error_m: float) -> Done:
    end = outcomes[-1] if outcomes else began
    last = end.world
    return Done(
        fell=last.fallen,
        stopped=_goes_on(end),
        measures=merged(outcome.measures for outcome in outcomes if outcome.measures is not None),
        duration_s=(last.tick - began.world.tick) * CONTROL_PERIOD_S,
        way_m=way_m,
        error_m=error_m,
    )


def _goes_on(outcome: Outcome) -> bool:
    return outcome.world.path is not None and not (outcome.world.fallen or outcome.world.path.done)


def _round(value: float | np.floating[Any], n_digits: int = 3) -> float:
    return round(float(value), n_digits)
