"""Callbacks and loggers of other packages that end a training, fail, or are none."""

import inspect
import threading
from pathlib import Path
from typing import Any

import pytest
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import KVWriter

from agent_proc.learning.loggers import registry
from agent_proc.learning.loggers.registry import make_callbacks, make_loggers, require_tools
from agent_proc.learning.training import Training
from agent_proc.learning.training_plan import TrainingPlan, TrainingResult, again
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.studies.cell_parts import new_simulator
from agent_proc.task.file import load_task
from legpush.errors import ConfigError, PluginError
from legpush.lockstep.local import LocalWorld
from tests.agent.learning.small_training import small_profile

N_STEPS = 20


class Counts(BaseCallback):
    """Counts what it is asked for."""

    calls: list[str]

    def __init__(self, plan: TrainingPlan, folder: Path) -> None:
        super().__init__()
        type(self).calls = []

    def _on_training_start(self) -> None:
        self.calls.append("start")

    def _on_rollout_start(self) -> None:
        self.calls.append("rollout")

    def _on_step(self) -> bool:
        assert len(self.locals["infos"]) == 1
        self.calls.append("step")
        return True

    def _on_rollout_end(self) -> None:
        self.calls.append("rolled out")

    def _on_training_end(self) -> None:
        self.calls.append("end")


class Ends(Counts):
    """Ends the training after some steps."""

    def _on_step(self) -> bool:
        return self.num_timesteps < N_STEPS


class Fails(Counts):
    """Raises an exception."""

    def _on_step(self) -> bool:
        raise KeyError("weights")


class Refuses(Counts):
    """Raises an error of this package."""

    def _on_step(self) -> bool:
        raise ConfigError("as it is")


class FailingLog(KVWriter):
    """A logger that raises an exception."""

    def __init__(self, plan: TrainingPlan, folder: Path, step: int) -> None:
        pass

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        raise OSError("no network")

    def close(self) -> None:
        pass


def unable(*_: object) -> None:
    raise RuntimeError("no licence")


PLUGINS: dict[str, Any] = {
    "counts": Counts,
    "ends": Ends,
    "fails": Fails,
    "refuses": Refuses,
    "fails_to_log": FailingLog,
    "unable": unable,
    "three": lambda *_: 3,
    "no_function": 3,
}


@pytest.fixture(autouse=True)
def installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The plug-ins of this file."""
    monkeypatch.setattr(registry, "load_plugin", lambda _, name: PLUGINS[name])
    monkeypatch.setattr(registry, "plugin_names", lambda _: tuple(PLUGINS))


def plan_with(loggers: tuple[str, ...] = (), callbacks: tuple[str, ...] = ()) -> TrainingPlan:
    return TrainingPlan(
        profile=small_profile(steps=64, evaluate_every=64, evaluation_episodes=1),
        task=load_task("tuned", max_steps=8),
        seed=3,
        n_simulators=1,
        command="",
        versions={},
        world="map",
        loggers=loggers,
        callbacks=callbacks,
    )


def train(folder: Path, **tools: tuple[str, ...]) -> TrainingResult:
    worlds, plan = [LocalWorld(new_simulator("map"))], plan_with(**tools)
    env = PushVecEnv(plan.task, worlds)
    try:
        return Training(plan, folder, env, worlds, stop=threading.Event()).run()
    finally:
        env.close()


def test_a_callback_is_asked_for_all_that_it_can_do(tmp_path: Path) -> None:
    assert train(tmp_path, callbacks=("counts",)).ended_by is None
    assert (Counts.calls[:3], Counts.calls[-2:]) == (["start", "rollout", "step"], ["rolled out", "end"])
    assert Counts.calls.count("step") == 64


def test_a_training_that_a_callback_ends_is_finished_and_leaves_its_policies(tmp_path: Path) -> None:
    result = train(tmp_path, callbacks=("counts", "ends"))
    assert (result.finished, result.step, result.ended_by) == (True, N_STEPS, "ends")
    assert result.best is not None
    assert result.best.step == N_STEPS
    for name in ("best", "last"):
        assert (tmp_path / name / "policy.safetensors").is_file()


@pytest.mark.parametrize(
    ("tools", "message"),
    [
        ({"callbacks": ("fails",)}, r"The callback 'fails' failed at {file}:{fails} \(KeyError: 'weights'\)$"),
        ({"loggers": ("fails_to_log",)}, r"The logger 'fails_to_log' failed at {file}:\d+ \(OSError: no network\)$"),
        ({"callbacks": ("unable",)}, r"The callback 'unable' failed at {file}:\d+ \(RuntimeError: no licence\)$"),
        ({"callbacks": ("three",)}, "The callback 'three': expected a BaseCallback of Stable-Baselines3, got int$"),
        ({"loggers": ("three",)}, "The logger 'three': expected a KVWriter of Stable-Baselines3, got int$"),
    ],
)
def test_one_that_fails_is_named_with_its_line(tmp_path: Path, tools: dict[str, tuple[str, ...]], message: str) -> None:
    fails = inspect.getsourcelines(Fails._on_step)[1] + 1
    with pytest.raises(PluginError, match=message.format(file=__file__, fails=fails)):
        train(tmp_path, **tools)


def test_an_error_of_this_package_stays_as_it_is(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"^as it is$"):
        train(tmp_path, callbacks=("refuses",))


def test_what_cannot_be_called_is_refused_before_anything_is_written() -> None:
    with pytest.raises(PluginError, match="a class or a function for --callbacks, got 'no_function'"):
        require_tools((), ("no_function",), ("no_function",))


def test_they_are_made_in_the_order_of_their_names(tmp_path: Path) -> None:
    plan = plan_with(callbacks=("ends", "counts"), loggers=("csv", "fails_to_log"))
    assert [callback.name for callback in make_callbacks(plan, tmp_path)] == ["ends", "counts"]
    assert len(make_loggers(plan, tmp_path, 0)) == 2


def test_the_command_that_goes_on_repeats_what_runs_code() -> None:
    assert again(Path("t"), ("tensorboard", "csv"), ()) == "legpush train --resume t"
    assert again(Path("t"), ("csv", "mine"), ("a", "b")) == "legpush train --loggers mine --callbacks a b --resume t"
