"""The state as it is perceived."""

from math import pi, radians

import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import BoxState, Perceived
from tests.legpush.examples import WORLD

SEEN_BOX = BoxState(position_m=(4.1, 2.0, 0.2), orientation_wxyz=(1.0, 0.0, 0.0, 0.0))
SEEN = Perceived(trunk=Pose2(x_m=1.0, y_m=2.0, yaw_rad=pi / 2), trunk_tick=200, box=SEEN_BOX, box_tick=205)


def test_what_is_known_as_it_is_stays_the_same() -> None:
    world = replace(WORLD, perceived=None)
    assert as_seen(world) is world


def test_robot_and_box_stand_where_they_are_perceived() -> None:
    world = replace(WORLD, perceived=SEEN)
    seen = as_seen(world)
    assert seen.perceived is None
    assert seen.box == SEEN_BOX
    trunk = planar_pose(seen.trunk)
    assert (trunk.x_m, trunk.y_m, trunk.yaw_rad) == pytest.approx((1.0, 2.0, pi / 2))
    assert seen.trunk.position_m[2] == world.trunk.position_m[2]


def test_the_feet_move_along_with_the_trunk() -> None:
    world = replace(WORLD, perceived=replace(SEEN, trunk=Pose2(x_m=0.3, y_m=0.1, yaw_rad=radians(7.0))))
    seen = as_seen(world)
    for true, moved in zip(world.tips_m, seen.tips_m, strict=True):
        before = planar_pose(world.trunk).inverse() @ Pose2(x_m=true[0], y_m=true[1], yaw_rad=0.0)
        after = planar_pose(seen.trunk).inverse() @ Pose2(x_m=moved[0], y_m=moved[1], yaw_rad=0.0)
        assert (after.x_m, after.y_m, moved[2]) == pytest.approx((before.x_m, before.y_m, true[2]))
