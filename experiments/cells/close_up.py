"""The kind of cell that records one push: leg and box from the side, tick by tick (Fig. 9), and the whole robot at the
tick in which the box presses the most (Figs. 1 to 3).

Places are in a frame with its origin on the floor, below the middle of the face of the box as it was before the push; x
is ahead, y to the left, z up.
"""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from msgspec import Struct

from agent_proc.push_model.calibration import open_floor
from experiments.cells.push_curve import foot_path
from legpush.arrays import Floats
from legpush.bounds import BoxMass, Depth, Unit
from legpush.fields import Seed
from legpush.geometry import Pose2, rectangle_corners, rotation_from_rpy, rpy_from_quaternion
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset, Trace
from legpush.scene.conventions import LEGS, FrontLeg
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, PoseDeg
from legpush.study.cells import CellKind, Column, as_it_is
from sim_proc.kinematics.leg import SIDE, LegKinematics
from sim_proc.simulator import Simulator

LIFTED_TICKS: Final = 5
"""Ticks after which the foot has left the floor."""
PLACES: Final = ("hip", "knee", "foot", "box")

COLUMNS: Final = (
    *(
        Column(name=f"{name}_{axis}_m", unit="m", about=f"of the {name}, by tick of the curve")
        for name in PLACES
        for axis in ("x", "z")
    ),
    Column(name="force_n", unit="N", about="on the foot, from floor and box, by tick of the curve"),
    Column(name="press_tick", unit="", about="tick of the curve in which the box presses the most"),
    *(
        Column(name=f"press_{name}_m", unit="m", about=f"{about} in that tick: x, y and z of each, one after the other")
        for name, about in (
            ("trunk", "corners of the trunk's middle plane"),
            ("hip_x", "hip-x joints, FL, FR, RL, RR"),
            ("hip_y", "hip-y joints"),
            ("knee", "knees"),
            ("foot", "feet"),
            ("com", "centre of mass"),
        )
    ),
    Column(name="press_forces_n", unit="N", about="forces on the feet in that tick, as the places"),
    Column(name="press_moment_n_m", unit="N m", about="sum of Eq. 9 in that tick: x, y, z"),
    Column(name="box_length_m", unit="m", about="along the push"),
    Column(name="box_height_m", unit="m", about="of the box"),
    Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state"),
)


class CloseUp(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A push of a box of the default size."""

    mass_kg: BoxMass
    w1: Unit
    w2: Unit
    leg: FrontLeg
    depth_m: Depth
    seed: Seed


def close_up(cell: CloseUp) -> Mapping[str, Any]:
    """Push once.

    Raises:
        RuntimeError: The simulator made no trace.
    """
    box = Box(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0), mass_kg=cell.mass_kg)
    scenario = open_floor(RobotSpec(), box, "rear")
    simulator = Simulator()
    before = planar_pose(simulator.perform(Reset(scenario=scenario, seed=cell.seed), with_trace=False).world.box)
    push = Push(w1=cell.w1, w2=cell.w2, leg=cell.leg, depth_m=cell.depth_m)
    outcome = simulator.perform(push, with_trace=True)
    if outcome.trace is None:
        raise RuntimeError("Expected a trace of the push, got none")
    leg, robot = LEGS.index(cell.leg), scenario.robot
    foot = foot_path(outcome.trace, leg, robot.pushing.push_ticks)
    face = before @ Pose2(x_m=-box.size_m[0] / 2, y_m=0.0, yaw_rad=0.0)
    hips, knees = leg_points_m(robot, foot.qpos, leg)
    boxes = np.column_stack([foot.qpos[:, 19:21], np.full(len(foot.qpos), box.size_m[2] / 2)])
    places: dict[str, Floats] = {}
    for name, points in zip(PLACES, (hips, knees, foot.tips_m, boxes), strict=True):
        places[f"{name}_x_m"] = seen_from(face, points)[:, 0]
        places[f"{name}_z_m"] = points[:, 2]
    force_n = np.linalg.norm(foot.forces_n, axis=1)
    press_tick = LIFTED_TICKS + int(np.argmax(force_n[LIFTED_TICKS:]))
    return {
        **{name: values.round(4) for name, values in places.items()},
        "force_n": force_n.round(2),
        "press_tick": press_tick,
        **_pressed(robot, face, outcome.trace, foot.first_row + press_tick),
        "box_length_m": box.size_m[0],
        "box_height_m": box.size_m[2],
        "state_crc": f"{outcome.state_crc:08x}",
    }


def _pressed(robot: RobotSpec, face: Pose2, trace: Trace, row: int) -> dict[str, Any]:
    """Return places, forces and moment of the whole robot in a row of a trace."""
    qpos = np.array(trace.qpos)[row : row + 1]
    turn = rotation_from_rpy(*rpy_from_quaternion(qpos[0, 3:7]))
    hips_b, (length_m, width_m) = LegKinematics(robot).hips_b, robot.trunk.size_m[:2]
    corners_b = np.column_stack([rectangle_corners(length_m, width_m), np.zeros(4)])
    legs = [leg_points_m(robot, qpos, leg) for leg in range(len(LEGS))]
    places = {
        "trunk": qpos[0, :3] + corners_b @ turn.T,
        "hip_x": qpos[0, :3] + hips_b @ turn.T,
        "hip_y": np.concatenate([hips for hips, _ in legs]),
        "knee": np.concatenate([knees for _, knees in legs]),
        "foot": np.array(trace.tips_m[row]),
        "com": np.array([trace.com_m[row]]),
    }
    yaw = Pose2(x_m=0.0, y_m=0.0, yaw_rad=face.yaw_rad)
    forces_n, moment_n_m = np.array(trace.contact_forces_n[row]), np.array([trace.foot_moment_n_m[row]])
    return {
        **{f"press_{name}_m": seen_from(face, points).ravel().round(4) for name, points in places.items()},
        "press_forces_n": seen_from(yaw, forces_n).ravel().round(2),
        "press_moment_n_m": seen_from(yaw, moment_n_m).ravel().round(3),
    }


def seen_from(frame: Pose2, points: Floats) -> Floats:
    """Return points of the world, (n, 3), in a frame on the floor."""
    return np.column_stack([frame.inverse().apply(points[:, :2]), points[:, 2]])


def leg_points_m(robot: RobotSpec, qpos: Floats, leg: int) -> tuple[Floats, Floats]:
    """Return hip-y axis and knee of a leg in the world, (n, 3) each, from generalized positions (n, 26)."""
    legs, hips_b = robot.legs, LegKinematics(robot).hips_b
    q1, q2 = qpos[:, 7 + 3 * leg : 9 + 3 * leg].T
    across, down = np.full(len(qpos), SIDE[leg] * legs.hip_offset_m), -legs.upper_length_m * np.cos(q2)
    hip_h = np.stack([0 * q1, across * np.cos(q1), across * np.sin(q1)], axis=1)
    upper_h = np.stack([-legs.upper_length_m * np.sin(q2), -down * np.sin(q1), down * np.cos(q1)], axis=1)
    turns = np.array([rotation_from_rpy(*rpy) for rpy in rpy_from_quaternion(qpos[:, 3:7])])
    hips: Floats = qpos[:, :3] + np.einsum("nij,nj->ni", turns, hips_b[leg] + hip_h)
    knees: Floats = hips + np.einsum("nij,nj->ni", turns, upper_h)
    return hips, knees


CLOSE_UP: Final = CellKind(specification=CloseUp, run=close_up, resolved=CloseUp, resolve=as_it_is, columns=COLUMNS)
"""The kind of cell."""
