"""The world as whoever pushes sees it: the face that is pushed is the rear one, and the goal a target of its frame."""

from math import cos, degrees, sin

from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.stepping import WorldState
from legpush.scene.faces import TURN_RAD, pushed_box
from legpush.scene.scenario import Face, PoseDeg, Scenario


def pushed_world(world: WorldState, face: Face) -> WorldState:
    """The same world, with the axes of the box turned so that the face is its rear one."""
    if face == "rear":
        return world
    w, x, y, z = world.box.orientation_wxyz
    c, s = cos(TURN_RAD[face] / 2), sin(TURN_RAD[face] / 2)
    turned = (w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s)
    return replace(world, box=replace(world.box, orientation_wxyz=turned))


def pushed_scenario(scenario: Scenario, face: Face, target: Pose2) -> Scenario:
    """The scenario of that world, with a target instead of its goal: a pose of the frame that is pushed."""
    goal = PoseDeg(x_m=target.x_m, y_m=target.y_m, yaw_deg=degrees(target.yaw_rad))
    return replace(scenario, box=pushed_box(scenario.box, face), goal=replace(scenario.goal, pose=goal))
