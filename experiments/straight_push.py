"""`python -m experiments.straight_push`: draws corners of the box and angles of the trunk in straight pushes (Fig. 17).

The shipped policy pushes a box 1 m ahead from unseen starts, with one simulator in this process.
`results/straight_push.png` shows the tracks of the four corners from above, roll and pitch of the trunk at every
control tick, and the errors after each push cycle.
"""

import sys
from dataclasses import dataclass
from math import degrees
from typing import Final

import numpy as np
import tyro
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import push_view
from agent_proc.policies.registry import make_policy
from experiments.evaluations import RESULTS
from legpush.arrays import Floats
from legpush.geometry import Pose2, rectangle_corners, rpy_from_quaternion
from legpush.messages.stepping import Reset
from legpush.scenarios.file import load_scenario
from legpush.scene.robot import CONTROL_PERIOD_S
from legpush.scene.scenario import Scenario
from sim_proc.simulator import Simulator

BOX: Final = slice(19, 26)
"""Place of the box's pose in a row of `qpos`."""
CORNERS: Final = ("front left", "rear left", "rear right", "front right")


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which pushes to draw."""

    policy: str = "variable"
    first_seed: int = 20_000
    n_seeds: int = 5


@dataclass(frozen=True, kw_only=True)
class Track:
    """One push from start to end."""

    corners_m: Floats
    """(ticks, 4, 2)"""
    roll_pitch_deg: Floats
    """(ticks, 2)"""
    errors: Floats
    """Errors in metres and degrees, before the first push cycle and after each, (cycles + 1, 2)."""


def main(config: Config) -> int:
    """Push from every start and draw."""
    scenario = load_scenario("push")
    tracks = [
        track(scenario, seed, config.policy) for seed in range(config.first_seed, config.first_seed + config.n_seeds)
    ]
    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    above, tilt, position, angle = figure.subplots(2, 2).flat
    _draw_above(above, scenario, tracks)
    for one in tracks:
        time_s = CONTROL_PERIOD_S * np.arange(len(one.roll_pitch_deg))
        for column, color in ((0, "tab:blue"), (1, "tab:orange")):
            tilt.plot(time_s, one.roll_pitch_deg[:, column], color=color, linewidth=0.5, alpha=0.6)
        position.plot(100 * one.errors[:, 0], color="tab:green", alpha=0.7)
        angle.plot(one.errors[:, 1], color="tab:purple", alpha=0.7)
    tilt.set(xlabel="time [s]", ylabel="roll (blue), pitch (orange) [deg]", title="trunk; published: within ±5 deg")
    position.set(
        xlabel="push cycle", ylabel="position error [cm]", yscale="log", title="box position; published: 18 cm"
    )
    angle.set(xlabel="push cycle", ylabel="angle error [deg]", title="box angle; published: 0.59 deg")
    for axis in (tilt, position, angle):
        axis.grid(which="both", alpha=0.25)
    figure.suptitle(f"Straight push of 1 m at 0.1 kg, policy {config.policy}, {len(tracks)} unseen starts")
    figure.savefig(RESULTS / "straight_push.png", dpi=110)
    ends = np.array([one.errors[-1] for one in tracks])
    print(f"final errors: {100 * ends[:, 0].mean():.2f} cm, {ends[:, 1].mean():.2f} deg, n {len(ends)}")
    return 0


def track(scenario: Scenario, seed: int, policy_name: str) -> Track:
    """Push the box to its goal once."""
    simulator, policy = Simulator(), make_policy(policy_name)
    length_m, width_m, _ = scenario.box.size_m
    outline = rectangle_corners(length_m, width_m)
    outcome = simulator.perform(Reset(scenario=scenario, seed=seed), with_trace=False)
    corners, tilts, errors = [], [], [box_error(outcome.world, scenario)]
    while (push := policy.decide(push_view(outcome.world, scenario))) is not None:
        outcome = simulator.perform(push, with_trace=True)
        if outcome.trace is None or outcome.world.fallen:
            raise RuntimeError(f"seed {seed}: the robot fell")
        box = np.array(outcome.trace.qpos)[:, BOX]
        yaw_rad = rpy_from_quaternion(box[:, 3:])[:, 2]
        for (x_m, y_m), yaw in zip(box[:, :2].tolist(), yaw_rad.tolist(), strict=True):
            corners.append(Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw).apply(outline))
        tilts.append(np.degrees(outcome.trace.roll_pitch_rad))
        errors.append(box_error(outcome.world, scenario))
    return Track(
        corners_m=np.array(corners),
        roll_pitch_deg=np.concatenate(tilts),
        errors=np.array([(error.position_m, degrees(error.angle_rad)) for error in errors]),
    )


def _draw_above(axis: Axes, scenario: Scenario, tracks: list[Track]) -> None:
    goal = scenario.goal.pose.pose().apply(rectangle_corners(*scenario.box.size_m[:2]))
    for index, name in enumerate(CORNERS):
        for number, one in enumerate(tracks):
            axis.plot(*one.corners_m[:, index].T, color=f"C{index}", linewidth=0.8, label=name if number == 0 else None)
    for place in (0, -1):
        for one in tracks:
            axis.plot(*np.vstack([one.corners_m[place], one.corners_m[place][:1]]).T, color="gray", linewidth=0.5)
    axis.plot(*np.vstack([goal, goal[:1]]).T, color="black", linestyle="--", label="goal")
    axis.set(xlabel="x [m]", ylabel="y [m]", title="tracks of the corners", aspect="equal")
    axis.legend(fontsize=7, loc="lower right")


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
