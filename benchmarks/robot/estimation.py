"""`python -m benchmarks.robot.estimation`: how well the robot knows its own motion in the profile `real`, and its cost.

Each curved walk is controlled by the estimate. Its rivals are fed with the same readings: kinematic odometry, which
takes the feet that carry load as fixed and turns with the gyroscope, without a filter; the same with rolling feet; and
the estimator with feet that do not roll. The rival of the filtered fixes is the last fix. The numbers go to
`results/estimation.json`. It takes 6 min of CPU, and can be interrupted at any time: the same command goes on, from
results in `runs/benchmarks`. Times are measured at once, in the same process as the bare steps.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any, Final

import numpy as np
import tyro
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

from agent_proc.statistics.intervals import mean, median
from benchmarks.push_cycle import TimedSimulator
from benchmarks.report import write_report
from benchmarks.robot.kept import Kept
from benchmarks.robot.motions import curved_walk
from experiments.tables.parts import plain
from legpush.arrays import Flags, Floats
from legpush.geometry import Pose2, rpy_from_quaternion
from legpush.messages.stepping import Push, Reset
from legpush.realism.settings import Realism
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import FRONT_LEGS, TRUNK_QPOS
from sim_proc import simulator
from sim_proc.control.joint_commands import JointCommands
from sim_proc.control.plant import TickLog, Touchdown
from sim_proc.control.watch import Watch
from sim_proc.estimated_robot import STILL_TICKS, EstimatedRobot
from sim_proc.estimation import kernel, layout
from sim_proc.estimation.body import body_numbers
from sim_proc.estimation.estimator import COM_VELOCITY, RATE, ROTATION, TIPS, Estimator
from sim_proc.estimation.readings import GYRO, N_READINGS
from sim_proc.headless import mujoco
from sim_proc.kinematics.leg import SIDE, LegKinematics
from sim_proc.perception import planar
from sim_proc.physics.physics import Physics
from sim_proc.physics.senses import OwnSenses

REAL: Final = Realism(profile="real")
LOADED_N: Final = 30.0
"""A foot that carries more is taken as fixed by the rivals without a filter."""
REPEATS: Final = 5
"""How often the compiled functions take the ticks of a walk, to time them."""


Row = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Config:
    """How often to walk and push."""

    seeds: int = 20
    first_seed: int = 3100
    n_cycles: int = 40
    """Push cycles whose cost is measured."""


@dataclass
class Recorded:
    """What happened in a walk, and what was known of it."""

    robot: EstimatedRobot
    physics: Physics
    still: Floats
    """Readings of the robot that stands, (n, steps, 22)."""
    start: Pose2
    qpos: list[Floats] = field(default_factory=list)
    com_velocities_m_s: list[Floats] = field(default_factory=list)
    tips_m: list[Floats] = field(default_factory=list)
    readings: list[Floats] = field(default_factory=list)
    lifted: list[Flags] = field(default_factory=list)
    rows: list[Floats] = field(default_factory=list)
    poses: list[Floats] = field(default_factory=list)


class RecordedRobot(EstimatedRobot):
    """An `EstimatedRobot` that records its walk."""

    walks: list[Recorded] = []  # noqa: RUF012 - one list for all walks

    def __init__(self, physics: Physics, senses: OwnSenses) -> None:
        super().__init__(physics, senses)
        self.walks.append(Recorded(self, physics, senses.last[-STILL_TICKS:].copy(), physics.trunk_pose()))

    def run(self, commands: JointCommands, until: Touchdown | None = None, watch: Watch | None = None) -> TickLog:
        """Run, and record."""
        log, walk = super().run(commands, until, watch), self.walks[-1]
        walk.qpos.append(log.qpos)
        walk.com_velocities_m_s.append(log.steps.com_velocity_m_s[:, -1])
        walk.tips_m.append(log.tips_m)
        walk.readings.append(self._senses.last)
        walk.lifted.append(self.lifted)
        walk.rows.append(self._estimator.rows)
        walk.poses.append(self._estimator.trunk_poses())
        return log


def main(config: Config) -> None:
    """Walk and push, and report how well the motion was known and what that cost."""
    kept, seeds = Kept("estimation", Path(__file__).parent), range(config.first_seed, config.first_seed + config.seeds)
    walks = [kept.result(f"walk {seed}", tuple[Row, Row], partial(_walked, seed)) for seed in seeds]
    found, costs = [walk for walk, _ in walks], [cost for _, cost in walks]
    names = [name for name in found[0] if name not in ("seed", "fell", "way_m")]
    write_report(
        "estimation",
        {
            "n": config.seeds,
            "first_seed": config.first_seed,
            "n_falls": sum(row["fell"] for row in found),
            "mean": {name: plain(mean([float(row[name]) for row in found]), 5) for name in names},
            "most": {name: max(float(row[name]) for row in found) for name in names},
            "estimator_over_bare_steps": plain(median([cost["estimator"] / cost["bare"] for cost in costs]), 4),
            "push_cycle_over_bare_steps": _push_cycles(config.n_cycles),
            "walks": found,
        },
    )


def _walked(seed: int) -> tuple[Row, Row]:
    """Walk along a curve: how well the motion was known, and what that cost."""
    usual = vars(simulator)["_estimated"]
    vars(simulator)["_estimated"] = lambda physics: RecordedRobot(physics, physics.senses)
    try:
        RecordedRobot.walks.clear()
        walked = curved_walk(seed, realism=REAL)
        walk = RecordedRobot.walks[-1]
        errors = {"seed": seed, "way_m": walked.way_m, "fell": walked.fell, **_errors(walk, walked.way_m)}
        cost = _cost(walk)
    finally:
        vars(simulator)["_estimated"] = usual
    print(errors, cost, flush=True)
    return errors, cost


def _errors(walk: Recorded, way_m: float) -> dict[str, float]:
    """How far what was known is from what was, at the end of a walk and in its ticks."""
    qpos, rows, poses = (np.concatenate(each) for each in (walk.qpos, walk.rows, walk.poses))
    readings, lifted = np.concatenate(walk.readings), np.concatenate(walk.lifted)
    end = planar(qpos[-1, TRUNK_QPOS])
    age_s = walk.robot._estimator._age_s
    rotation = Rotation.from_rotvec(age_s * rows[:, RATE]) * Rotation.from_matrix(rows[:, ROTATION].reshape(-1, 3, 3))
    leaning = rotation.as_euler("xyz")[:, :2] - rpy_from_quaternion(qpos[:, 3:7])[:, :2]
    velocity = rows[:, COM_VELOCITY] - np.concatenate(walk.com_velocities_m_s)
    heights = (rows[1:, TIPS].reshape(-1, 4, 3) - np.concatenate(walk.tips_m)[:-1])[:, :, 2]
    seen, fix = walk.robot.perceived().trunk, walk.physics.perception.first_fix()
    assumed = walk.physics.assumed
    body = body_numbers(walk.physics.robot, np.array(assumed.model.opt.gravity), *assumed.moments())
    body[layout.RADIUS] = 0.0
    not_rolling = Estimator(body, walk.start, walk.still.reshape(-1, N_READINGS), walk.robot._senses.late_steps + 1)
    not_rolling.advance(readings, lifted)
    unrolled = not_rolling.trunk_poses()[-1]
    return {
        "drift": _off(poses[-1, 0], poses[-1, 1], end) / way_m,
        "drift_not_rolling": _off(unrolled[0], unrolled[1], end) / way_m,
        "drift_kinematic": _off(*_kinematic(walk, readings, rolling=False), end) / way_m,
        "drift_kinematic_rolling": _off(*_kinematic(walk, readings, rolling=True), end) / way_m,
        "heading_deg": float(np.degrees(abs((poses[-1, 2] - end.yaw_rad + np.pi) % (2 * np.pi) - np.pi))),
        "located_m": _off(seen.x_m, seen.y_m, end),
        "last_fix_m": _last_fix_m(walk, end) if fix is not None else 0.0,
        "leaning_deg": float(np.degrees(np.sqrt((leaning**2).sum(axis=1).mean()))),
        "velocity_m_s": float(np.sqrt((velocity**2).sum(axis=1).mean())),
        "feet_height_m": float(np.sqrt((heights**2).mean())),
    }


def _last_fix_m(walk: Recorded, end: Pose2) -> float:
    """How far the trunk is from where its last fix and the estimated motion since then put it."""
    perception = walk.physics.perception
    place = perception.place_of_world()
    if place is None:
        return 0.0
    seen = place.inverse() @ end
    return _off(seen.x_m, seen.y_m, end)


def _kinematic(walk: Recorded, readings: Floats, *, rolling: bool) -> tuple[float, float]:
    """Where the trunk is by the legs that carry load, taken as fixed or rolling, and by the gyroscope: no filter.

    The bias of the gyroscope and the attitude at the start are those of the robot at rest.
    """
    legs, radius_m = LegKinematics(walk.physics.robot), walk.physics.robot.legs.foot_radius_m
    bias = walk.still[..., GYRO].reshape(-1, 3).mean(axis=0)
    rotation = Rotation.from_euler("z", walk.start.yaw_rad)
    joints = readings[:, -1, 6:18].reshape(-1, 4, 3)
    tips_b = legs.forward(joints, SIDE) + legs.hips_b
    loads = -readings[..., 18:22].mean(axis=1)
    position, before = np.array([walk.start.x_m, walk.start.y_m, 0.0]), rotation.apply(tips_b[0])
    for tick in range(1, len(readings)):
        turned = rotation
        for sample in readings[tick, :, GYRO]:
            rotation *= Rotation.from_rotvec((sample - bias) * layout.STEP_S)
        after = rotation.apply(tips_b[tick])
        standing = (loads[tick] > LOADED_N) & (loads[tick - 1] > LOADED_N)
        moved = before - after
        if rolling:
            steps = joints[tick] - joints[tick - 1]
            turns = np.zeros((4, 3))
            turns[:, 0] = steps[:, 0]
            about_y = steps[:, 1] - steps[:, 2]
            turns[:, 1], turns[:, 2] = np.cos(joints[tick, :, 0]) * about_y, np.sin(joints[tick, :, 0]) * about_y
            turns = rotation.apply(turns) + (rotation * turned.inv()).as_rotvec()
            moved += np.cross(turns, [0.0, 0.0, radius_m])
        if standing.any():
            position += moved[standing].mean(axis=0)
        before = after
    return float(position[0]), float(position[1])


def _off(x_m: float, y_m: float, true: Pose2) -> float:
    return float(np.hypot(x_m - true.x_m, y_m - true.y_m))


def _cost(walk: Recorded) -> dict[str, float]:
    """Least time of the compiled functions, and of as many bare steps, over all ticks of a walk."""
    readings, lifted = np.concatenate(walk.readings), np.concatenate(walk.lifted)
    estimator, physics = walk.robot._estimator, walk.physics
    arrays = [array.copy() for array in estimator._arrays]
    out = np.empty((len(readings), layout.N_OUT))

    def least_s(work: Callable[[], object]) -> float:
        found = []
        for _ in range(REPEATS):
            began = perf_counter()
            work()
            found.append(perf_counter() - began)
        return min(found)

    return {
        "estimator": least_s(lambda: kernel.advance(*arrays, estimator._body, readings, lifted, out)),
        "bare": least_s(lambda: mujoco.mj_step(physics.model, physics.data, layout.STEPS * len(readings))),
    }


def _push_cycles(n: int) -> dict[str, Any]:
    """Time of whole push cycles over that of their bare steps, with sensors that are exact and with those of `real`."""
    usual, ratios = load_scenario("push"), {}
    own = Realism(profile="real", motor_strength=1.0, foot_friction=1.0, com_x_m=0.0, com_y_m=0.0, com_z_m=0.0)
    for name, realism in (("exact", Realism()), ("estimated", own)):
        timed, random = TimedSimulator(), np.random.default_rng(0)
        timed.perform(Reset(scenario=replace(usual, realism=realism), seed=0), with_trace=False)
        for index in range(n):
            w1, w2 = random.uniform(size=2).tolist()
            timed.perform(Push(w1=w1, w2=w2, leg=FRONT_LEGS[index % 2], depth_m=0.03), with_trace=False)
        ratios[name] = plain(median([cycle.cycle_s / cycle.bare_s for cycle in timed.cycles if cycle.is_repeated]), 3)
    return ratios


if __name__ == "__main__":
    main(tyro.cli(Config))
