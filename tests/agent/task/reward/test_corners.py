"""The reward of Eqs. 16 to 18 and the bonuses of the published code, against numbers worked out by hand."""

from math import hypot, pi, radians, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent_proc.frames.push_view import push_view
from agent_proc.task.episode import earned
from agent_proc.task.file import load_task
from agent_proc.task.reward.corners import CornersWithin
from agent_proc.task.term import EpisodeEnding, PushStep
from legpush.geometry import Pose2
from legpush.scene.scenario import Goal, PoseDeg, Scenario
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()
TRUNK = Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0)


def at(x_m: float, y_m: float, yaw_rad: float) -> Pose2:
    return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)


PAPER, RELEASE = load_task("paper-text"), load_task("release")


def step_to(
    box: Pose2, *, fallen: bool = False, scenario: Scenario = SCENARIO, ending: EpisodeEnding | None = None
) -> PushStep:
    view = push_view(make_state(TRUNK, box, fallen=fallen), scenario)
    return PushStep(first=view, before=view, after=view, ending=ending)


def reward_of(box: Pose2, *, fallen: bool = False, scenario: Scenario = SCENARIO) -> dict[str, float]:
    return earned(PAPER, step_to(box, fallen=fallen, scenario=scenario))


def test_a_box_at_its_goal_earns_nothing() -> None:
    reward = reward_of(at(7.0, 3.0, 0.0))

    assert list(reward.values()) == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_a_shifted_box_costs_ten_per_metre_and_corner() -> None:
    reward = reward_of(at(6.7, 3.4, 0.0))

    assert reward["position"] == pytest.approx(-10.0 * (0.5 + 0.5))
    assert (reward["angle"], reward["fall"]) == (0.0, 0.0)


def test_a_turned_box_costs_two_per_radian_and_what_its_corners_are_off() -> None:
    angle = 0.2
    corner_m = 2 * hypot(0.2, 0.25) * sin(angle / 2)

    reward = reward_of(at(7.0, 3.0, angle))

    assert reward["angle"] == pytest.approx(-2.0 * angle)
    assert reward["position"] == pytest.approx(-10.0 * 2 * corner_m)


def test_the_angle_is_wrapped() -> None:
    scenario = make_scenario(goal=Goal(pose=PoseDeg(x_m=7.0, y_m=3.0, yaw_deg=179.0)))

    reward = reward_of(at(7.0, 3.0, -pi + radians(1.0)), scenario=scenario)

    assert reward["angle"] == pytest.approx(-2.0 * radians(2.0))


def test_a_fall_costs_ten_and_nothing_else() -> None:
    standing = reward_of(at(6.0, 3.1, 0.1))
    fallen = reward_of(at(6.0, 3.1, 0.1), fallen=True)

    assert fallen["fall"] == -10.0
    assert standing == {**fallen, "fall": 0.0}


@given(x_m=st.floats(5.0, 8.0), y_m=st.floats(2.0, 4.0), yaw_rad=st.floats(-3.0, 3.0), fallen=st.booleans())
def test_no_term_is_ever_positive(x_m: float, y_m: float, yaw_rad: float, fallen: bool) -> None:
    reward = reward_of(at(x_m, y_m, yaw_rad), fallen=fallen)

    assert max(reward.values()) <= 0.0


def bonuses(box: Pose2, ending: EpisodeEnding | None = None) -> dict[str, float]:
    terms = earned(RELEASE, step_to(box, ending=ending))
    return {name: terms[name] for name in ("near", "both_near", "ends_near")}


@pytest.mark.parametrize(
    ("box", "ending", "expected"),
    [
        (at(7.0, 3.0, 0.0), "success", (100.0, 10_000.0, 100.0)),
        (at(6.85, 3.0, 0.0), "max_steps", (0.0, 0.0, 0.0)),
        (at(6.95, 3.08, 0.0), None, (100.0, 10_000.0, 0.0)),
        (at(6.97, 3.5, 0.0), "missed", (0.0, 0.0, 100.0)),  # Half a metre aside, and near in x alone.
        (at(6.97, 3.5, 0.0), None, (0.0, 0.0, 0.0)),
    ],
)
def test_the_published_code_pays_bonuses_near_the_goal(
    box: Pose2, ending: EpisodeEnding | None, expected: tuple[float, float, float]
) -> None:
    assert tuple(bonuses(box, ending).values()) == expected


def test_the_bonus_for_one_corner_is_paid_for_the_right_one() -> None:
    turned = at(7.0 - 0.02, 3.0, 0.5)  # The left front corner is farther off than the right one.
    left, right = (CornersWithin(corners=(corner,), within_m=0.16).value(step_to(turned)) for corner in (1, 2))

    assert (left, right) == (0.0, 1.0)
