"""What an evaluation judges on, by policy, task and scenario."""

from pathlib import Path

import pytest

from agent_proc.evaluation.evaluation_task import evaluation_task
from agent_proc.policies.folder import policy_path
from agent_proc.task.drawn import scenario_of_start
from agent_proc.task.file import load_task
from legpush.errors import ConfigError, PolicyError, ScenarioError
from legpush.scenarios.file import load_scenario


@pytest.fixture
def wide(tmp_path: Path) -> str:
    """The path of a folder whose card has a task that draws its goals."""
    (tmp_path / "wide").symlink_to(policy_path("wide"))
    return str(tmp_path / "wide")


def test_a_policy_without_a_card_is_judged_in_the_scenario() -> None:
    made = evaluation_task("scripted", None, None)
    assert (made.told, made.scenario) == ("the scenario push", load_scenario("push"))
    assert made.starts([made.scenario], [1, 2]) == [made.scenario] * 2
    assert evaluation_task("scripted", None, "sine").scenario == load_scenario("sine")


def test_a_policy_folder_is_judged_on_the_task_of_its_card(wide: str) -> None:
    made = evaluation_task(wide, None, None)
    assert made.told == (
        "the task that it was trained on, in the scenario open; each start draws distance_m, goal_bearing_deg, "
        "goal_yaw_deg"
    )
    first, second = made.starts([made.scenario], [1, 2])
    assert first.goal.pose != second.goal.pose != made.scenario.goal.pose
    assert first.mission.max_push_cycles == load_task("wide").max_steps


def test_a_scenario_takes_the_place_of_that_of_the_task(wide: str) -> None:
    made = evaluation_task(wide, None, "push")
    assert made.scenario.name == "push"
    assert made.scenario.goal.position_tolerance_m == load_task("wide").scenario.goal.position_tolerance_m
    assert made.drawn(made.scenario, 1).goal.pose != made.scenario.goal.pose


def test_another_task_may_be_named(wide: str) -> None:
    for policy in (wide, "scripted"):
        made = evaluation_task(policy, "push-l2", None)
        assert made.told.startswith("the task push-l2, in the scenario open; each start draws mass_kg, ")
        assert made.drawn(made.scenario, 7) == scenario_of_start(load_task("push-l2"), 7)
    made = evaluation_task(wide, "tuned", None)
    assert made.told == "the task tuned, in the scenario push"
    assert made.drawn(made.scenario, 7) == made.scenario


def test_changes_are_of_what_the_starts_leave_as_it_is() -> None:
    assert evaluation_task("scripted", "push-l2", None, ("room.slope_deg=2",)).scenario.room.slope_deg == 2.0
    assert evaluation_task("scripted", None, None, ("box.mass_kg=2",)).scenario.box.mass_kg == 2.0
    with pytest.raises(ConfigError, match=r"for --set, got box\.mass_kg, which each start of the task draws"):
        evaluation_task("scripted", "push-l2", None, ("box.mass_kg=2",))


@pytest.mark.parametrize(
    ("policy", "task", "scenario", "error", "message"),
    [
        ("scripted", "push-l9", None, ConfigError, "push-l9"),
        ("scripted", "push-l4", None, ConfigError, "whole missions"),
        ("scripted", None, "pusch", ScenarioError, "pusch"),
        ("nowhere", None, None, PolicyError, "nowhere"),
    ],
)
def test_what_cannot_be_used_is_named(
    policy: str, task: str | None, scenario: str | None, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        evaluation_task(policy, task, scenario)
