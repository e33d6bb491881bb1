"""Making the environment from plain data: its settings, and a simulator for itself."""

import gc
from typing import Any

import numpy as np
import pytest

from agent_proc.learning.env import PushEnv
from agent_proc.learning.make_env import make_push_env
from agent_proc.task.domain import Domain
from legpush.errors import ConfigError, PluginError, ScenarioError
from legpush.lockstep.local import LocalWorld
from legpush.scenarios.file import load_scenario
from sim_proc.simulator import Simulator
from tests.agent.fake_world import FakeWorld
from tests.agent.tasks import paper, tuned

PUSH_AHEAD = np.array([0.0, 0.0, 0.0, 0.0], dtype=np.float32)


def test_without_arguments_it_is_the_default_task() -> None:
    assert make_push_env(world=FakeWorld()).task == tuned()


def test_settings_are_fields_of_the_task_and_intervals_of_its_domain() -> None:
    env = make_push_env(
        world=FakeWorld(), scenario="push", entry="fixed", max_steps=9, mass_kg=[0.1, 1], distance_m=(0.2, 0.8)
    )

    domain = Domain(mass_kg=(0.1, 1.0), distance_m=(0.2, 0.8))
    assert env.task == tuned(entry="fixed", max_steps=9, domain=domain, scenario=load_scenario("push"))


def test_a_task_may_be_named() -> None:
    env = make_push_env("release", FakeWorld(), max_steps=7, box_xy_m=0.02)

    assert (env.task.max_steps, env.task.domain.box_xy_m, env.task.domain.box_yaw_deg) == (7, 0.02, 0.0)
    assert list(env.task.ending) == ["release"]


def test_a_task_is_taken_as_it_is() -> None:
    task = paper()

    assert make_push_env(task, FakeWorld()).task is task
    with pytest.raises(ConfigError, match="either a whole task or settings of one, got both: max_steps"):
        make_push_env(task, FakeWorld(), max_steps=9)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"max_step": 9}, ConfigError, r"among entry, .*max_steps, .*mass_kg, friction, .*box_yaw_deg, got max_step$"),
        ({"domain": {}}, ConfigError, "got domain$"),
        ({"max_steps": "many"}, ConfigError, r"settings of the task: at `max_steps`: .* a whole number, got .*'many'"),
        ({"entry": "random"}, ConfigError, "at `entry`: expected one of fixed, variable, got 'random'"),
        ({"mass_kg": [1.0]}, ConfigError, "at `domain.mass_kg`"),
        ({"mass_kg": [1.0, 0.1]}, ConfigError, r"0 < low <= high for mass_kg of the domain, got \(1.0, 0.1\)"),
        ({"max_steps": 0}, ConfigError, "at `max_steps`: expected a whole number from 1 to 10000, got 0"),
        ({"scenario": "pusch"}, ScenarioError, "pusch"),
        (
            {"task": "tund"},
            ConfigError,
            r"name of a task \(paper-learns, .*, wide\).*got 'tund'",
        ),
        ({"reward": {"fal": {}}}, ConfigError, "at `reward.fal`: expected one of the terms corner_distance, .*'fal'"),
        ({"world": None, "simulator": "moon"}, PluginError, r"a simulator \(.*mujoco.*\), got 'moon'"),
        ({"colour": "red"}, ConfigError, "Expected settings among .*, got colour"),
    ],
)
def test_an_argument_that_cannot_be_used_is_refused(
    arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        make_push_env(**{"world": FakeWorld(), **arguments})


def test_each_environment_has_a_simulator_of_its_own() -> None:
    first, second = make_push_env(), make_push_env()
    start, _ = first.reset(seed=1)
    first.step(PUSH_AHEAD)

    np.testing.assert_array_equal(second.reset(seed=1)[0], start)
    assert len(first.snapshot().pushes) == 1


def shared_world() -> tuple[LocalWorld, LocalWorld]:
    """The same world twice."""
    world = LocalWorld(Simulator())
    return world, world


def shared_simulator() -> tuple[LocalWorld, LocalWorld]:
    """Two worlds of one simulator."""
    simulator = Simulator()
    return LocalWorld(simulator), LocalWorld(simulator)


@pytest.mark.parametrize("pair", [shared_world, shared_simulator])
class TestTwoEnvironmentsOfOneSimulator:
    """The second one is refused until the first one gives the simulator up."""

    def test_the_second_one_is_refused(self, pair: Any) -> None:
        one, other = pair()
        first = make_push_env(world=one)

        with pytest.raises(ConfigError, match="a simulator of its own for each PushEnv, got one that another PushEnv"):
            make_push_env(world=other)
        assert first.reset(seed=0)[0] in first.observation_space

    def test_a_closed_environment_gives_the_simulator_up(self, pair: Any) -> None:
        one, other = pair()
        first = make_push_env(world=one)
        first.reset(seed=0)
        first.close()
        first.close()
        second = make_push_env(world=other)
        second.reset(seed=0)
        second.step(PUSH_AHEAD)

        with pytest.raises(ConfigError, match="there is no episode"):
            first.step(PUSH_AHEAD)
        with pytest.raises(ConfigError, match="a simulator of its own"):
            first.reset(seed=0)
        first.close()
        with pytest.raises(ConfigError, match="a simulator of its own"):
            first.reset(seed=0)

    def test_a_lost_environment_gives_the_simulator_up(self, pair: Any) -> None:
        one, other = pair()
        assert isinstance(make_push_env(world=one), PushEnv)
        gc.collect()

        assert make_push_env(world=other).reset(seed=0)


def test_a_closed_environment_may_be_reset_if_nobody_else_has_its_simulator() -> None:
    env = make_push_env(world=FakeWorld())
    start, _ = env.reset(seed=0)
    env.close()

    np.testing.assert_array_equal(env.reset(seed=0)[0], start)


def test_an_environment_pushes_in_the_map_by_its_name() -> None:
    env = make_push_env(simulator="map", max_steps=3)
    env.reset(seed=0)
    steps = [env.step(PUSH_AHEAD) for _ in range(3)]

    assert [truncated for *_, truncated, _ in steps] == [False, False, True]
    assert steps[-1][-1]["position_error_m"] < steps[0][-1]["position_error_m"]
