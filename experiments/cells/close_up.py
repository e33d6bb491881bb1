"""The kind of cell that records one push from the side, tick by tick: hip, knee, foot and box (Fig. 9).

Places are in the vertical plane of the push, ahead of the face of the box as it was before the push.
"""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from msgspec import Struct

from agent_proc.push_model.calibration import open_floor
from experiments.cells.push_curve import foot_path
from legpush.arrays import Floats
from legpush.bounds import Unit
from legpush.fields import Seed
from legpush.geometry import rotation_from_rpy, rpy_from_quaternion
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.conventions import LEGS, FrontLeg
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, PoseDeg
from legpush.study.cells import CellKind, Column, as_it_is
from sim_proc.kinematics.leg import SIDE, LegKinematics
from sim_proc.simulator import Simulator

PLACES: Final = ("hip", "knee", "foot", "box")

COLUMNS: Final = (
    *(
        Column(name=f"{name}_{axis}_m", unit="m", about=f"of the {name}, by tick of the curve")
        for name in PLACES
        for axis in ("x", "z")
    ),
    Column(name="force_n", unit="N", about="on the foot, from floor and box, by tick of the curve"),
    Column(name="box_length_m", unit="m", about="along the push"),
    Column(name="box_height_m", unit="m", about="of the box"),
    Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state"),
)


class CloseUp(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A push of the default box."""

    w1: Unit
    w2: Unit
    leg: FrontLeg
    depth_m: float
    seed: Seed


def close_up(cell: CloseUp) -> Mapping[str, Any]:
    """Push once.

    Raises:
        RuntimeError: The simulator made no trace.
    """
    box = Box(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0))
    scenario = open_floor(RobotSpec(), box, "rear")
    simulator = Simulator()
    before = planar_pose(simulator.perform(Reset(scenario=scenario, seed=cell.seed), with_trace=False).world.box)
    push = Push(w1=cell.w1, w2=cell.w2, leg=cell.leg, depth_m=cell.depth_m)
    outcome = simulator.perform(push, with_trace=True)
    if outcome.trace is None:
        raise RuntimeError("Expected a trace of the push, got none")
    leg = LEGS.index(cell.leg)
    foot = foot_path(outcome.trace, leg, scenario.robot.pushing.push_ticks)
    hips, knees = leg_points_m(scenario.robot, foot.qpos, leg)
    boxes = np.column_stack([foot.qpos[:, 19:21], np.full(len(foot.qpos), box.size_m[2] / 2)])
    places: dict[str, Floats] = {}
    for name, points in zip(PLACES, (hips, knees, foot.tips_m, boxes), strict=True):
        places[f"{name}_x_m"] = before.inverse().apply(points[:, :2])[:, 0] + box.size_m[0] / 2
        places[f"{name}_z_m"] = points[:, 2]
    return {
        **{name: values.round(4) for name, values in places.items()},
        "force_n": np.linalg.norm(foot.forces_n, axis=1).round(2),
        "box_length_m": box.size_m[0],
        "box_height_m": box.size_m[2],
        "state_crc": f"{outcome.state_crc:08x}",
    }


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
