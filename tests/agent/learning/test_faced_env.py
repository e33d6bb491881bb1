"""Environments whose actions choose the face: the robot walks around the box, and feels what the box does."""

import numpy as np
import pytest
from msgspec.structs import replace
from numpy.typing import NDArray

from agent_proc.learning.env import PushEnv
from agent_proc.map_world.simulator import MapSimulator, mean_map_simulator
from agent_proc.task.elements import observation_elements
from agent_proc.task.file import load_task
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Push, Walk
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.scenario import PoseDeg
from sim_proc.simulator import Simulator
from tests.agent.fake_world import FakeWorld, scenario_at_station


def faced(quarters: float) -> NDArray[np.float32]:
    """An action that turns by so many quarters to the left around the box, and pushes with FL."""
    return np.array([0.0, 0.0, -1.0, 0.0, quarters / 2], dtype=np.float32)


@pytest.mark.parametrize(("quarters", "face"), [(0, "rear"), (1, "right"), (-1, "left"), (2, "front"), (-2, "front")])
def test_an_action_of_a_level_with_faces_walks_to_the_face_and_pushes_there(quarters: int, face: str) -> None:
    env = PushEnv(load_task("push-l1", mirrored=False), LocalWorld(MapSimulator()))
    env.reset(seed=1)
    before = env.view

    _, _, _, _, info = env.step(faced(quarters))

    assert env.view.face == face
    assert env.view.world.push is not None
    seconds = (env.view.world.tick - before.world.tick) * CONTROL_PERIOD_S
    assert info["reward_terms"]["time"] == pytest.approx(-0.01 * seconds)
    assert (seconds > 20.0) == (quarters != 0)


def test_the_mirror_image_of_an_action_with_a_face_does_the_mirror_image() -> None:
    places = []
    for sign in (1.0, -1.0):
        task = load_task("push-l1")
        goal = PoseDeg(x_m=7.0, y_m=6.0 - sign * 0.5, yaw_deg=-sign * 40.0)
        scenario = replace(task.scenario, goal=replace(task.scenario.goal, pose=goal))
        env = PushEnv(task, LocalWorld(mean_map_simulator()))
        env.reset(seed=1, options={"scenario": scenario})
        observation, *_ = env.step(faced(1))
        places.append((observation, env.view.face))

    np.testing.assert_allclose(places[0][0], places[1][0], atol=1e-5)
    assert {face for _, face in places} == {"left", "right"}


def test_an_episode_with_walks_is_restored_bit_for_bit() -> None:
    env, other = (PushEnv(load_task("push-l1"), LocalWorld(Simulator())) for _ in range(2))
    env.reset(seed=2)
    for quarters in (1, 0, 2):
        here, *_ = env.step(faced(quarters))

    np.testing.assert_array_equal(other.restore(env.snapshot()), here)
    a, b = env.step(faced(-1)), other.step(faced(-1))
    np.testing.assert_array_equal(a[0], b[0])


def test_a_robot_that_falls_on_its_walk_does_not_push() -> None:
    task = load_task("push-l1", scenario_at_station(), mirrored=False)
    world = FakeWorld(falls_in=lambda motion, n: isinstance(motion, Walk) and n == 2)
    env = PushEnv(task, world)
    env.reset(seed=0)

    _, _, terminated, _, info = env.step(faced(1))

    assert (terminated, info["ending"]) == (True, "fell")
    assert world.simulator.n_done[Push] == 0


def test_what_pushes_have_shown_is_observed_where_a_task_asks_for_it() -> None:
    task = load_task("push-l2")
    env = PushEnv(task, LocalWorld(Simulator()))
    env.reset(seed=3)
    names = [element.name for element in observation_elements(task)]
    first, *_ = env.step(np.array([0.0, 0.0, -1.0, 1.0], dtype=np.float32))

    effects = [f"effect.{name}" for name in ("forward", "forward_other", "turn", "turn_other")]
    assert names[-8:] == ["lost_depth.depth", "drift.forward", "drift.left", "drift.turn", *effects]
    assert (first[-7:-4] != 0.0).any()
    assert first[-4:-2].min() > 0.0 > first[-2:].max()
    assert env.view.drift != (0.0, 0.0, 0.0)
