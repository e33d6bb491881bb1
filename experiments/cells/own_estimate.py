"""The kind of cell that lets a robot push a box four times, as it does before a mission without a push map.

It gives the turning radius that the robot assumes before these pushes and after them.
"""

from collections.abc import Mapping
from typing import Any, Final

from msgspec import Struct
from msgspec.structs import replace

from agent_proc.push_model.calibration import open_floor
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.model import NOMINAL
from agent_proc.pushing.calibrating import CALIBRATION_LEGS
from legpush.fields import Seed
from legpush.lockstep.local import LocalWorld
from legpush.messages.common import USUAL_DEPTH_M
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.names import BoxShape, Face
from legpush.scene.robot import RobotSpec
from legpush.study.cells import CellKind, Column, as_it_is
from sim_proc.simulator import Simulator

COLUMNS: Final = (
    Column(name="guessed_m", unit="m", about="turning radius that the robot guesses"),
    Column(name="own_m", unit="m", about="turning radius after four pushes"),
    Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state"),
)


class OwnEstimate(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A box, one of its faces, and the seed of its place."""

    seed: Seed
    face: Face
    size_m: tuple[float, float, float]
    mass_kg: float
    friction: float
    shape: BoxShape


def own_estimate(cell: OwnEstimate) -> Mapping[str, Any]:
    """Push the box with each leg twice, and estimate its turning circle."""
    box = replace(NOMINAL, size_m=cell.size_m, mass_kg=cell.mass_kg, friction=cell.friction, shape=cell.shape)
    estimate = PushEstimate(pushed_box(box, cell.face))
    guessed_m = estimate.turning_radius_m
    world = LocalWorld(Simulator())
    outcome = world.step(Reset(scenario=open_floor(RobotSpec(), box, cell.face), seed=cell.seed))
    before = pushed_pose(planar_pose(outcome.world.box), cell.face)
    for index in CALIBRATION_LEGS:
        push = Push(w1=0.5, w2=0.5, leg=FRONT_LEGS[index], depth_m=USUAL_DEPTH_M, face=cell.face)
        outcome = world.step(push)
        after = pushed_pose(planar_pose(outcome.world.box), cell.face)
        estimate.learn(before, push, after)
        before = after
    return {
        "guessed_m": guessed_m,
        "own_m": estimate.turning_radius_m,
        "state_crc": f"{outcome.state_crc:08x}",
    }


OWN_ESTIMATE: Final = CellKind(
    specification=OwnEstimate, run=own_estimate, resolved=OwnEstimate, resolve=as_it_is, columns=COLUMNS
)
"""The kind of cell."""
