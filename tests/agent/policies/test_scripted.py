"""The scripted policy in a world that follows its push model, or nearly."""

from dataclasses import dataclass
from math import degrees, hypot, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agent_proc.frames.push_view import push_view
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.model import MIRROR, PushModel
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.scenario import Goal, PoseDeg, Scenario
from tests.agent.fake_world import make_scenario, make_state

POLICY = ScriptedPolicy()
MODEL = PushModel()
FAR_AWAY = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)


def decide(box: Pose2, scenario: Scenario) -> Push | None:
    return POLICY.decide(push_view(make_state(FAR_AWAY, box), scenario))


@dataclass(frozen=True, kw_only=True)
class Reality:
    """How the world differs from the model."""

    noise: float
    """Standard deviation of travel and turn of one push, relative."""
    travel: float = 1.0
    turn: float = 1.0
    drift: float = 0.0
    """Sideways to the left, by travel."""


def push_to_the_end(
    scenario: Scenario, box: Pose2, reality: Reality, rng: np.random.Generator
) -> tuple[float, float, int]:
    """Position error, absolute angle error in degrees, and number of pushes of a whole mission, goal heading 0."""
    goal = scenario.goal.pose
    for n_pushes in range(100):
        push = decide(box, scenario)
        if push is None:
            return hypot(box.x_m - goal.x_m, box.y_m - goal.y_m), abs(degrees(box.yaw_rad)), n_pushes
        row = np.zeros((1, 3))
        forward, left, turn = MODEL.push(row, np.array([MIRROR[push.leg]]), np.array([push.depth_m]))[0]
        forward *= reality.travel * (1 + reality.noise * rng.standard_normal())
        turn *= reality.turn * (1 + reality.noise * rng.standard_normal())
        turn += radians(2.0) * reality.noise * rng.standard_normal()
        box = box @ Pose2(x_m=float(forward), y_m=float(left + reality.drift * forward), yaw_rad=float(turn))
    pytest.fail("the policy did not come to an end in 100 pushes")


@pytest.mark.parametrize(
    "reality",
    [
        Reality(noise=0.15),
        Reality(noise=0.15, travel=0.8, turn=1.3),
        Reality(noise=0.15, travel=1.2, turn=0.7),
        Reality(noise=0.1, travel=0.9, turn=0.8, drift=-0.04),
    ],
    ids=["noisy", "turns more", "turns less", "drifts"],
)
def test_the_box_reaches_its_goal_although_the_world_is_not_quite_the_model(reality: Reality) -> None:
    rng, n_cases = np.random.default_rng(11), 40
    outcomes = []
    for _ in range(n_cases):
        length_m = rng.uniform(1.0, 1.5)
        scenario = make_scenario()
        dx, dy, turn_deg = rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), rng.uniform(-5.0, 5.0)
        box = Pose2(x_m=scenario.goal.pose.x_m - length_m + dx, y_m=3.0 + dy, yaw_rad=radians(turn_deg))
        position_m, angle_deg, _ = push_to_the_end(scenario, box, reality, rng)
        outcomes.append(position_m <= 0.03 and angle_deg <= 3.0)

    assert sum(outcomes) >= 0.95 * n_cases


def test_in_the_world_of_the_model_the_box_ends_well_within_the_tolerances() -> None:
    rng = np.random.default_rng(3)
    starts = ((0.05, 5.0), (-0.05, 5.0), (0.2, 0.0), (0.0, 0.0), (0.3, 10.0), (-0.25, -10.0))
    ends = []
    for side_m, turn_deg in starts:
        box = Pose2(x_m=5.6, y_m=3.0 + side_m, yaw_rad=radians(turn_deg))
        ends.append(push_to_the_end(make_scenario(), box, Reality(noise=0.0), rng))

    positions_m, angles_deg, n_pushes = np.array(ends).T
    assert positions_m.mean() <= 0.009
    assert positions_m.max() <= 0.015
    assert angles_deg.max() <= 1.5
    assert n_pushes.min() >= 1.2 / 0.0736
    assert n_pushes.max() <= 45


@settings(max_examples=30, deadline=None)
@given(
    ahead=st.floats(-1.5, -0.1),
    side=st.floats(0.005, 0.15),
    turn=st.floats(-0.3, 0.3),
    heading=st.sampled_from([0.0, 90.0, -123.0]),
)
def test_a_mirrored_situation_is_answered_with_the_other_leg_and_the_same_depth(
    ahead: float, side: float, turn: float, heading: float
) -> None:
    scenario = make_scenario()
    goal = scenario.goal.pose.pose() @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=radians(heading))
    turned = make_scenario(goal=Goal(pose=PoseDeg(x_m=goal.x_m, y_m=goal.y_m, yaw_deg=heading)))
    answers = [decide(goal @ Pose2(x_m=ahead, y_m=sign * side, yaw_rad=sign * turn), turned) for sign in (1.0, -1.0)]

    left, right = answers
    if left is None or right is None:
        assert left is right is None
    else:
        assert {left.leg, right.leg} == {"FL", "FR"}
        assert left.depth_m == right.depth_m


@pytest.mark.parametrize(("turn_deg", "leg"), [(12.0, "FL"), (-12.0, "FR")])
def test_a_turned_box_is_turned_back(turn_deg: float, leg: str) -> None:
    box = Pose2(x_m=6.0, y_m=3.0, yaw_rad=radians(turn_deg))

    push = decide(box, make_scenario())

    assert push is not None
    assert push.leg == leg


def test_the_depth_never_exceeds_the_remaining_distance() -> None:
    scenario = make_scenario()
    n_pushes = 0
    for remaining_m in (0.02, 0.035, 0.05, 0.07):
        box = Pose2(x_m=7.0 - remaining_m, y_m=3.0, yaw_rad=radians(4.0))
        push = decide(box, scenario)
        if push is not None:
            n_pushes += 1
            assert push.depth_m <= remaining_m + 0.02
    assert n_pushes > 0


@pytest.mark.parametrize("beyond_m", [0.0, 0.01, 0.3])
def test_a_box_at_or_beyond_its_goal_is_not_pushed(beyond_m: float) -> None:
    box = Pose2(x_m=7.0 + beyond_m, y_m=3.0, yaw_rad=0.0)

    assert decide(box, make_scenario()) is None
