"""The kind of cell that records a straight push: the box, the tilt of the trunk, and the errors after each cycle."""

from collections.abc import Collection, Mapping
from math import degrees
from typing import Any, Final

import numpy as np
from msgspec import Struct

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import push_view
from agent_proc.studies.cell_parts import policy_with, sha256_of_policy
from legpush.fields import Seed
from legpush.geometry import rpy_from_quaternion
from legpush.messages.poses import as_seen
from legpush.messages.stepping import Reset
from legpush.policy_names import DEFAULT_POLICY
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column
from sim_proc.simulator import Simulator

BOX: Final = slice(19, 26)
"""Place of the box's pose in a row of `qpos`."""
EVERY_TICKS: Final = 5
"""A recorded push has every n-th control tick."""

COLUMNS: Final = (
    *(
        Column(name=f"box_{name}", unit=unit, about="of the box, by time")
        for name, unit in (("x_m", "m"), ("y_m", "m"))
    ),
    Column(name="box_yaw_deg", unit="deg", about="of the box, by time"),
    Column(name="roll_deg", unit="deg", about="of the trunk, by time"),
    Column(name="pitch_deg", unit="deg", about="of the trunk, by time"),
    Column(name="error_m", unit="m", about="of the box's position, before the first push cycle and after each"),
    Column(name="error_deg", unit="deg", about="of the box's angle, before the first push cycle and after each"),
    Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state"),
)


class StraightPush(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A push of the built-in scenario `push`."""

    seed: Seed
    policy: str = DEFAULT_POLICY


class ResolvedPush(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A push that needs no other file than those of its policy."""

    seed: Seed
    policy: str
    policy_sha256: str
    scenario: Scenario


def resolve(cell: StraightPush, allowed: Collection[str]) -> ResolvedPush:
    """Hash the policy.

    Raises:
        PolicyError: It cannot be used.
    """
    sha256 = sha256_of_policy(cell.policy, allowed)
    return ResolvedPush(seed=cell.seed, policy=cell.policy, policy_sha256=sha256, scenario=load_scenario("push"))


def straight_push(cell: ResolvedPush) -> Mapping[str, Any]:
    """Push the box to its goal once.

    Raises:
        RuntimeError: The robot fell.
    """
    simulator, policy = Simulator(), policy_with(cell.policy, cell.policy_sha256)
    outcome = simulator.perform(Reset(scenario=cell.scenario, seed=cell.seed), with_trace=False)
    poses, tilts, errors = [], [], [box_error(outcome.world, cell.scenario)]
    while (push := policy.decide(push_view(as_seen(outcome.world), cell.scenario))) is not None:
        outcome = simulator.perform(push, with_trace=True)
        if outcome.trace is None or outcome.world.fallen:
            raise RuntimeError(f"seed {cell.seed}: the robot fell")
        box = np.array(outcome.trace.qpos)[:, BOX]
        poses.append(np.column_stack([box[:, :2], np.degrees(rpy_from_quaternion(box[:, 3:])[:, 2])]))
        tilts.append(np.degrees(outcome.trace.roll_pitch_rad))
        errors.append(box_error(outcome.world, cell.scenario))
    x_m, y_m, yaw_deg = np.concatenate(poses)[::EVERY_TICKS].round(3).T
    roll_deg, pitch_deg = np.concatenate(tilts)[::EVERY_TICKS].round(3).T
    return {
        "box_x_m": x_m,
        "box_y_m": y_m,
        "box_yaw_deg": yaw_deg,
        "roll_deg": roll_deg,
        "pitch_deg": pitch_deg,
        "error_m": [error.position_m for error in errors],
        "error_deg": [degrees(error.angle_rad) for error in errors],
        "state_crc": f"{outcome.state_crc:08x}",
    }


STRAIGHT_PUSH: Final = CellKind(
    specification=StraightPush, run=straight_push, resolved=ResolvedPush, resolve=resolve, columns=COLUMNS
)
"""The kind of cell."""
