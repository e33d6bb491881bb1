"""Space around the goal, against rectangles of shapely."""

from math import radians

import pytest
from msgspec.structs import replace
from shapely import Polygon, box

from agent_proc.pushing.docking.search import AREA_M
from agent_proc.pushing.docking.space import DockSpace
from legpush.geometry import Pose2
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.footprints import Footprint, box_footprint, robot_footprint
from legpush.scene.names import Face
from legpush.scene.scenario import Rectangle, Room, Scenario
from legpush.scene.station import station
from tests.agent.fake_world import make_scenario

WALL = Rectangle(x_min_m=7.3, x_max_m=7.8, y_min_m=3.15, y_max_m=3.65)


def scenario(*obstacles: Rectangle) -> Scenario:
    return replace(make_scenario(), room=Room(size_m=(12.0, 6.0), obstacles=obstacles))


def polygon(footprint: Footprint) -> Polygon:
    return Polygon(footprint.corners())


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("y_m", [-0.3, -0.1, 0.0, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("yaw_deg", [0.0, 20.0])
def test_box_and_robot_keep_the_margin_from_obstacles(face: Face, y_m: float, yaw_deg: float) -> None:
    room = scenario(WALL)
    goal = room.goal.pose.pose()
    at = Pose2(x_m=0.0, y_m=y_m, yaw_rad=radians(yaw_deg))
    space = DockSpace(room, goal @ Pose2(x_m=-0.5, y_m=-0.5, yaw_rad=0.0), AREA_M)

    pose = goal @ at
    trunk = station(room.robot, pushed_box(room.box, face), pushed_pose(pose, face))
    solid = box(7.3, 3.15, 7.8, 3.65)
    apart_m = min(
        polygon(box_footprint(room.box, pose)).distance(solid),
        polygon(robot_footprint(room.robot, trunk)).distance(solid),
    )

    assert space.is_free(at, face) == (apart_m >= room.pushing.margin_m)


def test_a_box_may_stay_as_near_to_things_as_it_is() -> None:
    room = scenario(replace(WALL, x_min_m=7.0))
    near = Pose2(x_m=0.0, y_m=-0.105, yaw_rad=0.0)
    far, there = (
        DockSpace(room, room.goal.pose.pose() @ place, AREA_M)
        for place in (Pose2(x_m=0.0, y_m=-0.5, yaw_rad=0.0), near)
    )
    assert not far.is_free(near, "rear")
    assert there.is_free(near, "rear")
    assert not there.is_free(Pose2(x_m=0.0, y_m=-0.1, yaw_rad=0.0), "rear")


def test_the_border_of_the_room_counts() -> None:
    room = replace(scenario(), room=Room(size_m=(7.6, 6.0)))
    space = DockSpace(room, room.goal.pose.pose(), AREA_M)
    assert space.is_free(Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), "rear")
    assert not space.is_free(Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), "front")
