"""Moves near the goal: what pushes do at each face, and how long walks take."""

from math import hypot, pi

import pytest

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.docking.moves import DEEPEST_M, DEPTHS_M, HALF_S, QUARTER_S, dock_pushes, walk_s
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.names import Face
from tests.agent.pushing.docking.boxes import BOX, estimates


@pytest.mark.parametrize("face", FACES)
def test_a_push_at_a_face_does_what_the_estimate_says_of_the_pushed_frame(face: Face) -> None:
    estimate, box = PushEstimate(pushed_box(BOX, face)), Pose2(x_m=2.0, y_m=1.0, yaw_rad=0.7)
    for push in dock_pushes(estimates())[face]:
        expected = estimate.after(pushed_pose(box, face), Push(w1=0.5, w2=0.5, leg=push.leg, depth_m=push.depth_m))
        got = pushed_pose(push.after(box), face)
        assert (got.x_m, got.y_m, got.yaw_rad) == pytest.approx((expected.x_m, expected.y_m, expected.yaw_rad))


def test_the_depth_that_a_heavy_box_loses_comes_on_top() -> None:
    light, heavy = estimates(), estimates()
    before = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    for _ in range(10):
        heavy["rear"].learn(before, Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.02), before)
    lost_m = heavy["rear"].lost_depth_m
    assert lost_m > 0.005
    for usual, deeper in zip(dock_pushes(light)["rear"], dock_pushes(heavy)["rear"], strict=True):
        assert deeper.depth_m == pytest.approx(min(usual.depth_m + lost_m, DEEPEST_M))
        assert hypot(deeper.x_m, deeper.y_m) < hypot(usual.x_m, usual.y_m) + 1e-9
    assert [push.depth_m for push in dock_pushes(light)["rear"]] == [*DEPTHS_M, *DEPTHS_M]


def test_walks_take_longer_to_the_opposite_face() -> None:
    assert walk_s("rear", "rear") == 0.0
    assert [walk_s("rear", "left"), walk_s("left", "front")] == pytest.approx([QUARTER_S, QUARTER_S])
    assert [walk_s("rear", "front"), walk_s("left", "right")] == pytest.approx([HALF_S, HALF_S])
    assert walk_s(None, "rear") == QUARTER_S


def test_turns_are_wrapped() -> None:
    turned = dock_pushes(estimates())["rear"][-1].after(Pose2(x_m=0.0, y_m=0.0, yaw_rad=pi - 0.01))
    assert -pi < turned.yaw_rad <= pi
