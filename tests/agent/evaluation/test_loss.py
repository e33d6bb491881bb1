import pytest

from agent_proc.evaluation.loss import MOST, episode_loss
from legpush.scenarios.file import load_scenario


def test_the_loss_is_the_larger_error_in_tolerances_and_at_most_1_for_a_success() -> None:
    goal = load_scenario("push").goal
    position_m, angle_deg = goal.position_tolerance_m, goal.angle_tolerance_deg
    assert episode_loss(True, position_m, 0.0, goal) == pytest.approx(1.0)
    assert episode_loss(True, 0.1 * position_m, 2.0 * angle_deg, goal) == pytest.approx(2.0)
    assert episode_loss(True, 50.0 * position_m, 0.0, goal) == MOST


def test_an_episode_that_did_not_end_by_itself_costs_the_most_wherever_the_box_is() -> None:
    assert episode_loss(False, 0.0, 0.0, load_scenario("push").goal) == MOST
