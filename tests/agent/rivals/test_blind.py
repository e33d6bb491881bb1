import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import push_view
from agent_proc.rivals.blind import action_grid, zero_action
from agent_proc.rivals.registry import make_rival
from agent_proc.studies.cell_parts import new_simulator
from agent_proc.task.file import load_task
from legpush.errors import ConfigError
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Reset

TASKS = ("tuned", "paper-learns", "release")


@pytest.mark.parametrize("name", TASKS)
def test_every_action_of_the_grid_is_one_of_the_task(name: str) -> None:
    task = load_task(name)
    world = LocalWorld(new_simulator("map"))
    view = push_view(world.step(Reset(scenario=task.scenario, seed=1)).world, task.scenario)
    grid = action_grid(task)
    pushes = {repr(make_rival("constant", task, action).decide(view)) for action in grid}
    assert len(pushes) == len(set(grid)) == {"tuned": 90, "paper-learns": 18, "release": 18}[name]
    assert make_rival("zero", task, ()).decide(view) == make_rival("constant", task, zero_action(task)).decide(view)


@pytest.mark.parametrize("name", TASKS)
def test_a_random_policy_draws_another_push_for_another_view_and_the_same_for_the_same(name: str) -> None:
    task = load_task(name)
    world, policy = LocalWorld(new_simulator("map")), make_rival("random", task, ())
    outcome, pushes = world.step(Reset(scenario=task.scenario, seed=1)), []
    for _ in range(4):
        view = push_view(outcome.world, task.scenario)
        push = policy.decide(view)
        assert push is not None
        assert policy.decide(view) == push
        pushes.append(repr(push))
        outcome = world.step(push)
    assert len(set(pushes)) == 4


def test_a_rival_ends_where_an_episode_of_its_task_ends() -> None:
    task = load_task("tuned")
    world = LocalWorld(new_simulator("map"))
    outcome = world.step(Reset(scenario=task.scenario, seed=1))
    goal, box = task.scenario.goal.pose, outcome.world.box
    arrived = replace(box, position_m=(goal.x_m, goal.y_m, box.position_m[2]))
    there = push_view(replace(outcome.world, box=arrived), task.scenario)
    assert make_rival("zero", task, ()).decide(there) is None
    assert make_rival("random", task, ()).decide(there) is None


def test_an_action_of_another_length_is_refused() -> None:
    with pytest.raises(ConfigError, match="Expected an action of 3 numbers, as the task has, got"):
        make_rival("constant", load_task("paper-learns"), (0.0, 0.0, 0.0, 0.0))
