"""Policies in the files of Stable-Baselines3 itself."""

import base64
import importlib
import json
import pickle
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from stable_baselines3 import A2C, DQN, PPO, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

from agent_proc.frames.push_view import push_view
from agent_proc.learning.env import PushEnv
from agent_proc.policies.registry import make_policy
from agent_proc.task.action import to_push
from agent_proc.task.observed import observe
from legpush.errors import PolicyError
from tests.agent.fake_world import FakeWorld, make_state, scenario_at_station
from tests.agent.tasks import paper, tuned

SCENARIO = scenario_at_station()
VIEW = push_view(make_state(SCENARIO.start.pose(), SCENARIO.box.pose.pose()), SCENARIO)
TASKS = {
    "relative, variable": tuned(scenario=SCENARIO),
    "paper, fixed": paper(entry="fixed", scenario=SCENARIO),
    "paper, discrete": paper(entry="fixed", action_form="discrete", scenario=SCENARIO),
}


def saved(path: Path, kind: Callable[..., BaseAlgorithm], env: gymnasium.Env[Any, Any] | VecNormalize) -> BaseAlgorithm:
    """A new model of that kind, in that file."""
    model = kind("MlpPolicy", env, seed=0, device="cpu", policy_kwargs={"net_arch": [8]})
    model.save(path)
    return model


@pytest.mark.parametrize("kind", [PPO, A2C, SAC, TD3])
@pytest.mark.parametrize("name", ["relative, variable", "paper, fixed"])
def test_a_model_pushes_as_it_predicts(tmp_path: Path, kind: type[BaseAlgorithm], name: str) -> None:
    task = TASKS[name]
    model = saved(tmp_path / "model.zip", kind, PushEnv(task, FakeWorld()))
    action, _ = model.predict(observe(task, VIEW), deterministic=True)

    push = make_policy(str(tmp_path / "model.zip"), trust_file=True).decide(VIEW)

    assert push == to_push(action, task, VIEW)


def test_a_model_of_the_published_grid_is_known_by_its_actions(tmp_path: Path) -> None:
    saved(tmp_path / "model.zip", PPO, PushEnv(TASKS["paper, discrete"], FakeWorld()))

    push = make_policy(str(tmp_path / "model.zip"), trust_file=True).decide(VIEW)

    assert push is not None
    assert (push.w1 * 10) % 1 == pytest.approx(0.0, abs=1e-9)


def test_a_normalizer_shows_the_model_what_it_saw_in_training(tmp_path: Path) -> None:
    task = TASKS["relative, variable"]
    env = VecNormalize(DummyVecEnv([lambda: PushEnv(task, FakeWorld())]))
    env.reset()
    moments: Any = env.obs_rms
    moments.mean[:], moments.var[:] = 0.3, 4.0
    model = saved(tmp_path / "model.zip", PPO, env)
    env.save(str(tmp_path / "normalize.pkl"))
    seen = np.clip((observe(task, VIEW) - 0.3) / np.sqrt(4.0 + env.epsilon), -10, 10)
    action, _ = model.predict(seen.astype(np.float32), deterministic=True)

    with_it = make_policy(str(tmp_path / "model.zip"), tmp_path / "normalize.pkl", trust_file=True).decide(VIEW)
    without = make_policy(str(tmp_path / "model.zip"), trust_file=True).decide(VIEW)

    assert with_it is not None
    assert without is not None
    expected = to_push(action, task, VIEW)
    assert (with_it.w1, with_it.w2, with_it.depth_m) == pytest.approx((expected.w1, expected.w2, expected.depth_m))
    assert with_it.leg == expected.leg
    assert abs(with_it.w1 - without.w1) > 1e-6


def test_a_file_that_is_no_model_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.zip").write_text("no zip")

    with pytest.raises(PolicyError, match=r"text.zip: expected a model saved by Stable-Baselines3"):
        make_policy(str(tmp_path / "text.zip"), trust_file=True)
    with pytest.raises(PolicyError, match=r"none.zip: expected a model saved by Stable-Baselines3.*No such file"):
        make_policy(str(tmp_path / "none.zip"), trust_file=True)


def test_a_model_of_another_task_is_refused_with_the_spaces_that_fit(tmp_path: Path) -> None:
    saved(tmp_path / "other.zip", PPO, gymnasium.make("CartPole-v1"))
    saved(tmp_path / "dqn.zip", DQN, gymnasium.make("CartPole-v1"))

    with pytest.raises(
        PolicyError, match=r"other.zip: expected observations of shape .*\(25,\) \(paper-text\).*got \(4,\)"
    ):
        make_policy(str(tmp_path / "other.zip"), trust_file=True)
    with pytest.raises(PolicyError, match=r"dqn.zip: expected a model of PPO, A2C, SAC, TD3 or DDPG"):
        make_policy(str(tmp_path / "dqn.zip"), trust_file=True)


def test_a_normalizer_that_does_not_fit_is_refused(tmp_path: Path) -> None:
    saved(tmp_path / "model.zip", PPO, PushEnv(TASKS["relative, variable"], FakeWorld()))
    other = VecNormalize(DummyVecEnv([lambda: gymnasium.make("CartPole-v1")]))
    other.save(str(tmp_path / "other.pkl"))
    (tmp_path / "dict.pkl").write_bytes(pickle.dumps({}))

    with pytest.raises(PolicyError, match=r"other.pkl: expected 8 means.*got 4"):
        make_policy(str(tmp_path / "model.zip"), tmp_path / "other.pkl", trust_file=True)
    with pytest.raises(PolicyError, match=r"dict.pkl: expected a `VecNormalize` with norm_obs, got dict"):
        make_policy(str(tmp_path / "model.zip"), tmp_path / "dict.pkl", trust_file=True)
    with pytest.raises(PolicyError, match=r"Expected a model file \(.zip\) with --normalizer, got 'scripted'"):
        make_policy("scripted", tmp_path / "other.pkl")


MY_NETS = """
import torch
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor


class Extractor(BaseFeaturesExtractor):
    def __init__(self, space):
        super().__init__(space, 8)
        self.layer = torch.nn.Linear(space.shape[0], 8)

    def forward(self, seen):
        if seen.shape[0] == 1 and BROKEN:
            raise RuntimeError("broken on purpose")
        return self.layer(seen)


BROKEN = False
"""


def test_a_model_that_needs_a_module_of_the_user_works_with_it_and_names_it_without(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "my_nets.py").write_text(MY_NETS)
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path)])
    my_nets = importlib.import_module("my_nets")
    env = PushEnv(TASKS["relative, variable"], FakeWorld())
    model = PPO("MlpPolicy", env, device="cpu", policy_kwargs={"features_extractor_class": my_nets.Extractor})
    model.save(tmp_path / "model.zip")

    policy = make_policy(str(tmp_path / "model.zip"), trust_file=True)
    assert policy.decide(VIEW) is not None
    monkeypatch.setattr(my_nets, "BROKEN", True)
    with pytest.raises(PolicyError, match=r"model\.zip: `decide` raised RuntimeError at tick 0: broken on purpose"):
        policy.decide(VIEW)

    sys.path.remove(str(tmp_path))
    monkeypatch.delitem(sys.modules, "my_nets")
    with pytest.raises(
        PolicyError, match=r"model\.zip: .* it needs the module my_nets, which is not on the Python path"
    ):
        make_policy(str(tmp_path / "model.zip"), trust_file=True)


class Raises:
    """What raises an error when it is unpickled."""

    def __init__(self, error: BaseException) -> None:
        self.error = error

    def __reduce__(self) -> Any:
        return (throw, (self.error,))


def throw(error: BaseException) -> None:
    raise error


ERRORS = (
    *(TypeError("no args"), AssertionError("not with CUDA"), ModuleNotFoundError(), ZeroDivisionError(), SystemExit(0)),
    *(RecursionError(), MemoryError(), KeyError("k"), ImportError("half"), StopIteration(), Exception("line\nbreak")),
)


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_whatever_a_pickle_raises_is_one_line_with_the_file_and_the_class(error: BaseException, tmp_path: Path) -> None:
    saved(tmp_path / "model.zip", PPO, PushEnv(TASKS["relative, variable"], FakeWorld()))
    (tmp_path / "normalize.pkl").write_bytes(pickle.dumps(Raises(error)))
    with pytest.raises(
        PolicyError, match=rf"normalize\.pkl: expected .* can be loaded here \({type(error).__name__}"
    ) as it:
        make_policy(str(tmp_path / "model.zip"), tmp_path / "normalize.pkl", trust_file=True)
    assert "\n" not in str(it.value)

    with zipfile.ZipFile(tmp_path / "model.zip") as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    plain = json.loads(content["data"])
    plain["clip_range"][":serialized:"] = base64.b64encode(pickle.dumps(Raises(error))).decode()
    with zipfile.ZipFile(tmp_path / "bad.zip", "w") as archive:
        for name, data in {**content, "data": json.dumps(plain).encode()}.items():
            archive.writestr(name, data)
    if not isinstance(error, TypeError | RuntimeError):  # Stable-Baselines3 warns of these, and goes on
        with pytest.raises(PolicyError, match=rf"bad\.zip: .* can be loaded here \({type(error).__name__}"):
            make_policy(str(tmp_path / "bad.zip"), trust_file=True)
