"""The tracked corners of a box, against numbers worked out by hand."""

from math import cos, sin

import numpy as np
from msgspec.structs import replace

from agent_proc.frames.corners import goal_corners_m, tracked_corners_m
from legpush.geometry import Pose2
from legpush.scene.scenario import Goal, PoseDeg
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()
TRUNK = Pose2(x_m=5.0, y_m=2.0, yaw_rad=0.3)


def test_a_box_that_looks_along_y_has_its_front_left_corner_at_lower_x() -> None:
    state = make_state(TRUNK, Pose2(x_m=6.0, y_m=3.0, yaw_rad=np.pi / 2))

    corners = tracked_corners_m(state.box, SCENARIO.box)

    np.testing.assert_allclose(corners, [[6.0 - 0.25, 3.0 + 0.2, 0.4], [6.0 + 0.25, 3.0 + 0.2, 0.4]])


def test_a_tilted_box_lifts_its_corners() -> None:
    pitch = 0.1
    level = make_state(TRUNK, Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.0)).box
    tilted = replace(level, orientation_wxyz=(cos(pitch / 2), 0.0, -sin(pitch / 2), 0.0))

    corners = tracked_corners_m(tilted, SCENARIO.box)

    np.testing.assert_allclose(corners[:, 2], 0.2 + 0.2 * sin(pitch) + 0.2 * cos(pitch))


def test_the_corners_of_the_goal_are_those_of_a_box_that_is_there() -> None:
    goal = Goal(pose=PoseDeg(x_m=7.0, y_m=3.0, yaw_deg=30.0))
    there = make_state(TRUNK, goal.pose.pose())

    np.testing.assert_allclose(
        goal_corners_m(goal, SCENARIO.box), tracked_corners_m(there.box, SCENARIO.box)[:, :2], atol=1e-12
    )
