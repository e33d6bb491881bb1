"""The id of the environment: it is made alone, in vectors, by Stable-Baselines3, and in a fresh interpreter."""

import subprocess
import sys
import warnings
from textwrap import dedent
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray
from stable_baselines3.common.env_checker import check_env as check_env_sb3
from stable_baselines3.common.env_util import make_vec_env

import legpush.gym
from agent_proc.learning.env import PushEnv
from agent_proc.mission_env.env import MissionEnv
from agent_proc.task.file import load_task, task_names

ID = "legpush.gym:legpush/Push-v1"
LEVEL_4 = "legpush.gym:legpush/PushL4-v2"
SETTINGS: dict[str, Any] = {"scenario": "push", "entry": "fixed", "max_steps": 7, "mass_kg": [0.1, 1.0]}
SEED = 3
N_STEPS = 2


def run_fresh(program: str) -> str:
    """What a program writes in an interpreter of its own."""
    done = subprocess.run(
        [sys.executable, "-c", dedent(program)], capture_output=True, text=True, timeout=120.0, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def actions(seed: int) -> NDArray[np.float32]:
    """The actions of one environment, (steps, elements)."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (N_STEPS, 3)).astype(np.float32)


def rollout(seed: int) -> NDArray[np.float32]:
    """Observations of a single environment, (1 + steps, elements)."""
    env = gymnasium.make(ID, **SETTINGS)
    seen = [env.reset(seed=seed)[0], *(env.step(action)[0] for action in actions(seed))]
    env.close()
    return np.stack(seen)


def test_a_fresh_interpreter_makes_it_by_its_id_alone() -> None:
    said = run_fresh(
        f"""
        import gymnasium
        env = gymnasium.make("{ID}")
        observation, info = env.reset(seed=0)
        print(env.spec.id, env.observation_space.contains(observation), env.step(env.action_space.sample())[2])
        """
    )

    assert said.split() == ["legpush/Push-v1", "True", "False"]


def test_to_import_the_id_imports_no_process() -> None:
    said = run_fresh(
        """
        import sys, legpush.gym
        processes = {"agent_proc", "planner_proc", "sim_proc"}
        print(sorted(processes & set(sys.modules)), legpush.gym.PUSH_ID)
        """
    )

    assert said.split() == ["[]", "legpush/Push-v1"]


def test_its_arguments_are_plain_data_and_survive_json() -> None:
    env = gymnasium.make(ID, **SETTINGS)
    assert env.spec is not None
    again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))

    first, second = env.unwrapped, again.unwrapped
    assert isinstance(first, PushEnv)
    assert isinstance(second, PushEnv)
    assert second.task == first.task
    assert (first.task.max_steps, first.task.domain.mass_kg) == (7, (0.1, 1.0))
    np.testing.assert_array_equal(env.reset(seed=SEED)[0], again.reset(seed=SEED)[0])


def test_each_built_in_task_has_an_id() -> None:
    assert {row.task for row in legpush.gym.ENVIRONMENTS.values()} == set(task_names())
    for name, row in legpush.gym.ENVIRONMENTS.items():
        assert row.max_episode_steps == load_task(row.task).max_steps
        env = gymnasium.make(f"legpush.gym:{name}", max_steps=9).unwrapped
        assert isinstance(env, MissionEnv if row.make == legpush.gym.MAKE_MISSIONS else PushEnv)
        assert env.task == load_task(row.task, max_steps=9)


def test_the_checkers_of_gymnasium_and_stable_baselines_pass_without_a_warning() -> None:
    env = gymnasium.make(ID)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=True)
        check_env_sb3(env)


def test_actions_in_double_precision_and_out_of_range_are_clipped() -> None:
    rewards = []
    for action in (np.array([-1.0, 1.0, 1.0, 0.0], dtype=np.float32), np.array([-7.0, 1.5, 2.0, 0.0])):
        env = gymnasium.make(ID, disable_env_checker=True)
        env.reset(seed=SEED)
        rewards.append(env.step(action)[1])
        env.close()
    assert rewards[0] == rewards[1]


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_environments_side_by_side_do_what_each_does_alone(mode: str) -> None:
    envs = gymnasium.make_vec(ID, num_envs=2, vectorization_mode=mode, **SETTINGS)
    try:
        pairs = zip(actions(SEED), actions(SEED + 1), strict=True)
        seen = [envs.reset(seed=SEED)[0], *(envs.step(np.stack(pair))[0] for pair in pairs)]
    finally:
        envs.close()

    for index in range(2):
        np.testing.assert_array_equal(np.stack(seen)[:, index], rollout(SEED + index))


def test_stable_baselines_makes_vectors_of_it() -> None:
    envs = make_vec_env(ID, n_envs=2, seed=SEED, env_kwargs=SETTINGS)
    start = np.asarray(envs.reset())
    observations, rewards, _, infos = envs.step(np.stack([actions(0)[0], actions(1)[0]]))
    envs.close()

    assert np.asarray(observations).shape == start.shape == (2, 8)
    assert (start[0] != start[1]).any()
    for reward, info in zip(rewards, infos, strict=True):
        assert reward == pytest.approx(sum(info["reward_terms"].values()))


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_missions_run_side_by_side(mode: str) -> None:
    envs = gymnasium.make_vec(LEVEL_4, num_envs=2, vectorization_mode=mode, scenario="push")
    try:
        first = envs.reset(seed=SEED)[0]
        envs.step(envs.action_space.sample())
        again = envs.reset(seed=SEED)[0]
    finally:
        envs.close()

    np.testing.assert_array_equal(first, again)
    assert (first[0] != first[1]).any()
