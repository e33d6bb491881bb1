"""The vectorized environment: the same as its environments one by one, but at once."""

from collections.abc import Mapping
from threading import Barrier, BrokenBarrierError, Event, active_count

import numpy as np
import pytest
from msgspec.structs import replace
from numpy.typing import NDArray

from agent_proc.learning.env import PushEnv
from agent_proc.learning.vec_env import PushVecEnv
from legpush.errors import ConfigError, PeerError
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.world import SteppingWorld
from legpush.messages.stepping import Motion, Outcome, Push, Reset
from sim_proc.simulator import Simulator
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.tasks import tuned

TASK = tuned(scenario=scenario_at_station(), max_steps=3)
N_STEPS = 8


def actions(n_envs: int, seed: int = 0) -> NDArray[np.float32]:
    """For `N_STEPS` steps, (steps, environments, elements)."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (N_STEPS, n_envs, 4)).astype(np.float32)


class Meeting:
    """A world that answers only while its partner is asked as well."""

    def __init__(self, barrier: Barrier) -> None:
        self._barrier = barrier
        self._world = FakeWorld()

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        self._barrier.wait(timeout=20.0)
        return self._world.step(motion, with_trace=with_trace)

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        self._world.tell_reward(terms)


class Broken:
    """A world whose simulator is lost in the first push."""

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        if isinstance(motion, Push):
            raise PeerError("sim/sim1 is dead")
        return FakeWorld().step(motion, with_trace=with_trace)

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        raise AssertionError(terms)


def test_without_a_simulator_there_is_nothing_to_learn_with() -> None:
    with pytest.raises(ConfigError, match="at least one simulator"):
        PushVecEnv(TASK, [])


def test_it_does_what_its_environments_do_one_by_one_episode_after_episode() -> None:
    task = tuned(max_steps=3)
    vec = PushVecEnv(task, [LocalWorld(Simulator()), LocalWorld(Simulator())], seed=4)
    seeds = vec.seed(4)
    alone = [PushEnv(task, LocalWorld(Simulator())) for _ in seeds]
    np.testing.assert_array_equal(
        vec.reset(), [env.reset(seed=seed)[0] for env, seed in zip(alone, seeds, strict=True)]
    )
    n_ends = 0
    for step in actions(2):
        observations, rewards, dones, infos = vec.step(step)
        observations = np.asarray(observations)
        for index, env in enumerate(alone):
            observation, reward, terminated, truncated, info = env.step(step[index])
            assert infos[index]["TimeLimit.truncated"] == truncated
            if terminated or truncated:
                n_ends += 1
                np.testing.assert_array_equal(infos[index].pop("terminal_observation"), observation)
                observation, _ = env.reset()
            assert infos[index].items() >= info.items()
            assert "terminal_observation" not in infos[index]
            assert (rewards[index], dones[index]) == (np.float32(reward), terminated or truncated)
            np.testing.assert_array_equal(observations[index], observation)
    vec.close()
    assert n_ends == 4


def test_seeds_differ_from_environment_to_environment_and_from_seed_to_seed() -> None:
    vec = PushVecEnv(tuned(), [LocalWorld(Simulator()) for _ in range(2)], seed=1)
    starts = [*vec.reset()]
    vec.seed(2)
    starts += [*vec.reset()]
    vec.seed(1)
    np.testing.assert_array_equal(vec.reset(), starts[:2])
    vec.close()

    assert len({start.tobytes() for start in starts}) == 4


def test_all_simulators_start_and_step_at_the_same_time() -> None:
    barrier = Barrier(2)
    vec = PushVecEnv(TASK, [Meeting(barrier), Meeting(barrier)], seed=0)
    vec.reset()
    observations, *_ = vec.step(actions(2)[0])
    vec.close()

    assert len(observations) == 2
    assert not barrier.broken
    with pytest.raises(BrokenBarrierError):  # Alone, such a world never answers.
        Barrier(2).wait(timeout=0.01)


def test_a_simulator_that_is_lost_is_an_error_of_the_step_after_the_others_are_done() -> None:
    whole = FakeWorld()
    worlds: list[SteppingWorld] = [whole, Broken()]
    vec = PushVecEnv(TASK, worlds, seed=0)
    vec.reset()
    with pytest.raises(PeerError, match="sim/sim1 is dead"):
        vec.step(actions(2)[0])
    vec.close()

    assert len(whole.motions(Push)) == 1


def test_closing_ends_all_threads_and_sets_the_stop_event() -> None:
    stop = Event()
    n_before = active_count()
    barrier = Barrier(2)
    vec = PushVecEnv(TASK, [Meeting(barrier), Meeting(barrier)], seed=0, stop=stop)
    vec.reset()
    assert active_count() == n_before + 2
    vec.close()

    assert stop.is_set()
    assert active_count() == n_before


def test_restored_environments_go_on_bit_for_bit_with_the_episodes_that_follow() -> None:
    first, second = (PushVecEnv(TASK, [FakeWorld(), FakeWorld()], seed=seed) for seed in (0, 99))
    first.reset()
    for step in actions(2)[:4]:
        observations, *_ = first.step(step)

    np.testing.assert_array_equal(second.restore(first.snapshot()), observations)
    for step in actions(2)[4:]:
        for a, b in zip(first.step(step)[:3], second.step(step)[:3], strict=True):
            np.testing.assert_array_equal(a, b)
    assert first.snapshot() == second.snapshot()
    for vec in (first, second):
        vec.close()


def test_environments_are_restored_with_as_many_simulators_as_they_had() -> None:
    two, one = (PushVecEnv(TASK, [FakeWorld() for _ in range(n)], seed=0) for n in (2, 1))
    two.reset()

    with pytest.raises(ConfigError, match="as many simulators as were saved, 2, got 1"):
        one.restore(two.snapshot())
    for vec in (one, two):
        vec.close()


def test_options_hold_for_the_next_reset_alone() -> None:
    worlds = [FakeWorld(), FakeWorld()]
    vec = PushVecEnv(TASK, worlds, seed=0)
    heavy = replace(TASK.scenario, box=replace(TASK.scenario.box, mass_kg=5.0))
    vec.set_options([{"scenario_seed": 7}, {"scenario_seed": 8, "scenario": heavy}])
    vec.reset()
    vec.reset()
    vec.close()

    resets = [[motion for motion in world.motions(Reset) if isinstance(motion, Reset)] for world in worlds]
    assert [first.seed for first, _ in resets] == [7, 8]
    assert [first.scenario.box.mass_kg for first, _ in resets] == [0.1, 5.0]
    assert all(second.seed not in (7, 8) and second.scenario == TASK.scenario for _, second in resets)
