"""A stage of the box's path: where on it a pose is, and where it is straight."""

from math import degrees, pi, radians, sin

import numpy as np
import pytest

from agent_proc.pushing.stage import Stage, stages
from legpush.geometry import Pose2
from legpush.messages.planning import Plan
from legpush.scene.faces import FACES
from legpush.scene.names import Face
from tests.agent.pushing.paths import AXLE_M, BEHIND, START, line, quarter


def test_a_place_on_a_path_is_found_from_the_box_beside_it() -> None:
    path = Stage("rear", quarter(0.8, 0.5), AXLE_M)
    beside = path.pose(0.9) @ BEHIND @ Pose2(x_m=0.0, y_m=0.03, yaw_rad=radians(4.0))
    box = beside @ Pose2(x_m=AXLE_M, y_m=0.0, yaw_rad=0.0)

    deviation = path.deviation(box, 0.5, 1.2)

    assert path.length_m == pytest.approx(0.8 * pi / 2 + 0.5, rel=1e-3)
    assert deviation.distance_m == pytest.approx(0.9, abs=0.005)
    assert deviation.left_m == pytest.approx(0.03, abs=1e-3)
    assert degrees(deviation.heading_rad) == pytest.approx(4.0, abs=0.3)
    assert path.straight_until_m(0.5) == 0.5
    assert path.straight_until_m(1.4) == path.length_m
    assert path.pose(path.length_m) == path.end


@pytest.mark.parametrize("face", FACES)
def test_a_line_is_straight_to_its_end_whichever_face_is_pushed(face: Face) -> None:
    poses, end = line(face, 0.8)

    path = Stage(face, poses, AXLE_M)

    assert path.length_m == pytest.approx(0.8)
    assert path.straight_until_m(0.0) == path.length_m
    assert path.end.xy() == pytest.approx(end.xy())
    half = path.pose(0.4)
    assert (half.x_m, half.y_m, half.yaw_rad) == pytest.approx((START.x_m + 0.4, START.y_m, 0.0), abs=1e-9)


def test_a_straight_stretch_ends_where_an_arc_begins() -> None:
    straight, _ = line("rear", 0.7)
    arc = [straight[-1] @ BEHIND @ (START @ BEHIND).inverse() @ pose for pose in quarter(0.8, 0.5)]

    path = Stage("rear", (*straight, *arc), AXLE_M)

    assert path.straight_until_m(0.0) == pytest.approx(0.7)
    assert path.straight_until_m(0.6) == pytest.approx(0.7)
    assert path.straight_until_m(0.75) == 0.75


def test_a_path_goes_straight_on_beyond_its_end() -> None:
    poses, end = line("rear", 0.8)

    beyond = Stage("rear", poses, AXLE_M).pose(1.0)

    assert (beyond.x_m, beyond.y_m) == pytest.approx((end.x_m + 0.2, end.y_m))


@pytest.mark.parametrize("beside_m", [0.04, 0.06])
def test_a_place_is_looked_for_between_two_distances_only(beside_m: float) -> None:
    there = [Pose2(x_m=6.0 + k / 10, y_m=3.0, yaw_rad=0.0) for k in range(11)]
    back = [Pose2(x_m=7.0 - k / 10, y_m=3.1, yaw_rad=pi) for k in range(11)]
    path, box = Stage("rear", (*there, *back), 0.0), Pose2(x_m=6.5, y_m=3.0 + beside_m, yaw_rad=0.0)

    first, second = path.deviation(box, 0.0, 0.9), path.deviation(box, 1.2, path.length_m)

    assert (first.distance_m, first.left_m) == pytest.approx((0.5, beside_m))
    assert (second.distance_m, second.left_m) == pytest.approx((1.6, 0.1 - beside_m))
    assert abs(second.heading_rad) == pytest.approx(pi)


def test_deviations_of_many_poses_are_those_of_each() -> None:
    path = Stage("rear", quarter(0.8, 0.5), AXLE_M)
    poses = [path.pose(at_m) @ Pose2(x_m=0.0, y_m=0.02, yaw_rad=0.05) for at_m in (0.1, 0.7, 1.5)]

    rows = np.array([[pose.x_m, pose.y_m, pose.yaw_rad] for pose in poses])
    along, left, heading = path.deviations(rows, 0.0, path.length_m)

    for k, pose in enumerate(poses):
        one = path.deviation(pose, 0.0, path.length_m)
        assert (along[k], left[k], heading[k]) == (one.distance_m, one.left_m, one.heading_rad)


def test_poses_at_one_place_count_once() -> None:
    poses, _ = line("rear", 0.8)

    turned = poses[15] @ BEHIND @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=1e-6) @ BEHIND.inverse()
    path = Stage("rear", (poses[0], *poses[:16], turned, *poses[16:], poses[-1]), AXLE_M)

    assert path.length_m == pytest.approx(0.8)
    assert path.deviation(poses[0], 0.0, 0.1).distance_m == pytest.approx(0.0)
    assert path.straight_until_m(0.0) == path.length_m


def test_a_stage_may_end_elsewhere_than_its_last_pose() -> None:
    poses, _ = line("right", 0.8)
    end = poses[-1] @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.2)

    assert Stage("right", poses, AXLE_M, end).end.yaw_rad == pytest.approx(0.2)


def test_a_plan_is_cut_where_the_side_changes_and_each_part_has_the_face_of_its_side() -> None:
    along, across = line("rear", 0.6)[0], [Pose2(x_m=6.6, y_m=3.0 + k / 10, yaw_rad=0.0) for k in range(5)]
    waypoints = (*along, *across, *along)
    sides = (*(1,) * len(along), *(0,) * len(across), *(1,) * len(along))
    plan = Plan(status="exact", reason="", waypoints=waypoints, sides=sides)

    first, second, third = stages(plan, {"right": 0.1, "rear": AXLE_M})

    assert [stage.face for stage in (first, second, third)] == ["rear", "right", "rear"]
    assert (first.length_m, second.length_m) == pytest.approx((0.6, 0.4))
    assert second.pose(0.0).xy() == pytest.approx(across[0].xy())
    assert third.end.xy() == pytest.approx(along[-1].xy())
    turned = second.pose(0.2) @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.3)
    assert second.deviation(turned, 0.0, 0.4).left_m == pytest.approx(-0.1 * sin(0.3))
