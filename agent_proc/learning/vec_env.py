"""Pushing environments for Stable-Baselines3, each with a simulator of its own, stepped in parallel."""

import threading
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import Any

import numpy as np
from gymnasium import Env
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices, VecEnvStepReturn

from agent_proc.learning.env import EnvSnapshot, PushEnv
from agent_proc.task.config import TaskConfig
from legpush.errors import ConfigError
from legpush.lockstep.world import SteppingWorld

Step = tuple[NDArray[np.float32], float, bool, dict[str, Any]]


class PushVecEnv(VecEnv):
    """One environment per world, each on its own thread, so that a slow simulator does not block the others.

    Episodes end as in every `VecEnv`: the next one has begun when `step` returns, and the info contains
    `terminal_observation` and `TimeLimit.truncated`. The behaviour of environment i depends on the seed, i and its
    actions alone. An error in a world, such as the loss of its simulator, is raised by the step or reset in which it
    occurs.
    """

    def __init__(
        self,
        task: TaskConfig,
        worlds: Sequence[SteppingWorld],
        seed: int | None = None,
        stop: threading.Event | None = None,
    ) -> None:
        """Make an environment per world; `close` sets `stop`, so that no link goes on waiting.

        Raises:
            ConfigError: There is no world, or another environment steps one of them.
        """
        if not worlds:
            raise ConfigError("Expected at least one simulator to learn with, got none")
        self.envs = [PushEnv(task, world) for world in worlds]
        self._stop = stop
        self._threads = ThreadPoolExecutor(len(worlds), thread_name_prefix="push-env")
        self._steps: list[Future[Step]] = []
        super().__init__(len(worlds), self.envs[0].observation_space, self.envs[0].action_space)
        if seed is not None:
            self.seed(seed)

    def seed(self, seed: int | None = None) -> list[int]:
        """Set the seeds of the next reset, one per environment, all spawned from `seed`; returns them."""
        seeds = [int(child.generate_state(1)[0]) for child in np.random.SeedSequence(seed).spawn(self.num_envs)]
        self._seeds = list(seeds)
        return seeds

    def reset(self) -> NDArray[np.float32]:
        """Begin an episode in each environment; returns the observations, (n, elements)."""
        self._join(self._steps)
        self._steps = []

        def begin(index: int) -> tuple[NDArray[np.float32], dict[str, Any]]:
            return self.envs[index].reset(seed=self._seeds[index], options=self._options[index] or None)

        results = self._join([self._threads.submit(begin, index) for index in range(self.num_envs)])
        self.reset_infos = [info for _, info in results]
        self._reset_seeds()
        self._reset_options()
        return np.stack([observation for observation, _ in results])

    def step_async(self, actions: NDArray[Any]) -> None:
        """Start a step in each environment."""
        self._steps = [
            self._threads.submit(self._step, index, np.array(action)) for index, action in enumerate(actions)
        ]

    def step_wait(self) -> VecEnvStepReturn:
        """Wait for all steps, and return their results."""
        steps, self._steps = self._steps, []
        observations, rewards, dones, infos = zip(*self._join(steps), strict=True)
        return np.stack(observations), np.array(rewards, dtype=np.float32), np.array(dones), list(infos)

    def snapshot(self) -> tuple[EnvSnapshot, ...]:
        """The state from which `restore` continues bit for bit; to be called between steps only."""
        return tuple(env.snapshot() for env in self.envs)

    def restore(self, snapshots: Sequence[EnvSnapshot]) -> NDArray[np.float32]:
        """Continue from snapshots, in parallel; returns the observations, (n, elements).

        Raises:
            ConfigError: The number of snapshots differs from that of the environments.
        """
        if len(snapshots) != self.num_envs:
            raise ConfigError(f"Expected as many simulators as were saved, {len(snapshots)}, got {self.num_envs}")
        jobs = [self._threads.submit(env.restore, snapshot) for env, snapshot in zip(self.envs, snapshots, strict=True)]
        return np.stack(self._join(jobs))

    def close(self) -> None:
        """End the threads and close the environments; the worlds belong to the caller, and stay open."""
        if self._stop is not None:
            self._stop.set()
        self._threads.shutdown(cancel_futures=True)
        for env in self.envs:
            env.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Get the attribute of each environment."""
        return [getattr(env, attr_name) for env in self._chosen(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Set the attribute of each environment."""
        for env in self._chosen(indices):
            setattr(env, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:
        """Call the method of each environment, one after the other."""
        return [getattr(env, method_name)(*args, **kwargs) for env in self._chosen(indices)]

    def env_is_wrapped(self, wrapper_class: type[Env[Any, Any]], indices: VecEnvIndices = None) -> list[bool]:
        """False for each environment: none is wrapped."""
        return [False for _ in self._chosen(indices)]

    def _chosen(self, indices: VecEnvIndices) -> list[PushEnv]:
        return [self.envs[index] for index in self._get_indices(indices)]

    def _step(self, index: int, action: NDArray[Any]) -> Step:
        """Step an environment, and reset it at the end of an episode."""
        env = self.envs[index]
        observation, reward, terminated, truncated, info = env.step(action)
        info["TimeLimit.truncated"] = truncated and not terminated
        if terminated or truncated:
            info["terminal_observation"] = observation
            observation, self.reset_infos[index] = env.reset()
        return observation, reward, terminated or truncated, info

    @staticmethod
    def _join(jobs: Iterable[Future[Any]]) -> list[Any]:
        """Wait for all jobs, then return their results or raise the first error: no environment is left in a step."""
        jobs = list(jobs)
        wait(jobs)
        return [job.result() for job in jobs]
