"""Paths and references of the box to test with."""

from math import cos, degrees, pi, sin
from typing import Literal

from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.scene.faces import TURN_RAD
from legpush.scene.names import Face
from legpush.scene.reference import Arcs, Left, Reference, Right, Straight, reference_curve
from legpush.scene.scenario import Goal, PoseDeg, PushSettings, Scenario
from tests.agent.fake_world import scenario_at_station

AXLE_M = 0.146
START = Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.0)
BEHIND = Pose2(x_m=-AXLE_M, y_m=0.0, yaw_rad=0.0)

EIGHT = Arcs(
    radius_m=0.9,
    segments=(
        Straight(length_m=0.9),
        Right(angle_deg=90.0),
        Straight(length_m=0.5),
        Left(angle_deg=180.0),
        Straight(length_m=0.7),
    ),
)


def quarter(radius_m: float, straight_m: float) -> tuple[Pose2, ...]:
    """Box poses from `START`: an arc to the left about a point beside the axle, then straight on."""
    axle = START @ BEHIND
    angles = [pi / 2 * k / 60 for k in range(61)]
    arc = [axle @ Pose2(x_m=radius_m * sin(a), y_m=radius_m * (1 - cos(a)), yaw_rad=a) for a in angles]
    line = [arc[-1] @ Pose2(x_m=straight_m * k / 30, y_m=0.0, yaw_rad=0.0) for k in range(1, 31)]
    return tuple(pose @ Pose2(x_m=AXLE_M, y_m=0.0, yaw_rad=0.0) for pose in (*arc, *line))


def line(face: Face, length_m: float) -> tuple[tuple[Pose2, ...], Pose2]:
    """Box poses straight ahead along x, pushed at a face, and the pushed frame at their end."""
    pushed = [START @ Pose2(x_m=length_m * k / 30, y_m=0.0, yaw_rad=0.0) for k in range(31)]
    turned = Pose2(x_m=0.0, y_m=0.0, yaw_rad=-TURN_RAD[face])
    return tuple(pose @ turned for pose in pushed), pushed[-1]


def along(reference: Reference, composition: Literal["closed_loop", "open_loop"] = "closed_loop") -> Scenario:
    """Pushed along the reference, in a room that is large enough."""
    scenario = scenario_at_station()
    x_m, y_m, yaw_rad = reference_curve(reference, scenario.box.pose.pose())[-1].tolist()
    goal = Goal(pose=PoseDeg(x_m=x_m, y_m=y_m, yaw_deg=degrees(yaw_rad)))
    return replace(scenario, goal=goal, reference=reference, pushing=PushSettings(composition=composition))
