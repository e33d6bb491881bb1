import threading
from importlib.metadata import EntryPoint, EntryPoints
from importlib.metadata import entry_points as installed_entry_points
from pathlib import Path
from typing import Any

import pytest
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import KVWriter

from agent_proc.learning.loggers import registry
from agent_proc.learning.loggers.csv_log import CSV_FILE
from agent_proc.learning.loggers.registry import require_tools
from agent_proc.learning.training import Training
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.studies.cell_parts import new_simulator
from agent_proc.task.file import load_task
from legpush import plugins
from legpush.errors import ConfigError
from legpush.lockstep.local import LocalWorld
from tests.agent.learning.small_training import small_profile

SEEN: list[Any] = []


class OwnLog(KVWriter):
    """Remembers the steps at which something was logged."""

    def __init__(self, plan: TrainingPlan, folder: Path, step: int) -> None:
        SEEN.append((plan.seed, folder, step))

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        SEEN.append(step)

    def close(self) -> None:
        SEEN.append("closed")


class OwnCallback(BaseCallback):
    """Remembers how often it was called."""

    def __init__(self, plan: TrainingPlan, folder: Path) -> None:
        super().__init__()

    def _on_step(self) -> bool:
        SEEN.append("called")
        return True


@pytest.fixture
def own(monkeypatch: pytest.MonkeyPatch) -> None:
    """A logger and a callback of another package, both called `mine`."""
    SEEN.clear()
    points = [
        EntryPoint(name="mine", value=f"{__name__}:{name}", group=group)
        for name, group in (("OwnLog", registry.LOGGERS), ("OwnCallback", registry.CALLBACKS))
    ]

    def entry_points(**wanted: Any) -> EntryPoints:
        return EntryPoints([*installed_entry_points(**wanted), *EntryPoints(points).select(**wanted)])

    monkeypatch.setattr(plugins, "entry_points", entry_points)
    load = EntryPoint.load
    own = {point.value: globals()[point.attr] for point in points}
    monkeypatch.setattr(EntryPoint, "load", lambda self: own.get(self.value) or load(self))


@pytest.mark.usefixtures("own")
def test_loggers_and_callbacks_of_other_packages_take_part_and_change_nothing(tmp_path: Path) -> None:
    profile, task = small_profile(steps=32, evaluate_every=32, evaluation_episodes=1), load_task("tuned", max_steps=8)
    weights = []
    for name, loggers, callbacks in (("plain", (), ()), ("own", ("csv", "mine"), ("mine",))):
        plan = TrainingPlan(
            profile=profile,
            task=task,
            seed=3,
            n_simulators=1,
            command="",
            versions={},
            world="map",
            loggers=loggers,
            callbacks=callbacks,
        )
        worlds = [LocalWorld(new_simulator("map"))]
        env = PushVecEnv(task, worlds)
        (tmp_path / name).mkdir()
        assert Training(plan, tmp_path / name, env, worlds, stop=threading.Event()).run().finished
        env.close()
        weights.append((tmp_path / name / "last" / "policy.safetensors").read_bytes())

    assert weights[0] == weights[1]
    assert not (tmp_path / "plain" / CSV_FILE).exists()
    assert (tmp_path / "own" / CSV_FILE).read_text().startswith("step,")
    assert SEEN[0] == (3, tmp_path / "own", 0)
    assert SEEN.count("called") == 32
    assert SEEN[-1] == "closed"
    assert 32 in SEEN


@pytest.mark.usefixtures("own")
def test_what_runs_code_of_other_packages_has_to_be_named_on_the_command_line() -> None:
    require_tools(("csv", "mine"), ("mine",), ("mine",))
    with pytest.raises(ConfigError, match="mine is of another package and runs code: repeat it with --loggers mine"):
        require_tools(("mine",), (), ())
    with pytest.raises(ConfigError, match="repeat it with --callbacks mine"):
        require_tools((), ("mine",), ())


def test_unknown_names_and_missing_libraries_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ConfigError, match=r"names for --loggers \(tensorboard, csv, wandb\), got 'x'"):
        require_tools(("x",), (), ("x",))
    with pytest.raises(ConfigError, match=r"for --callbacks \(none is installed\), got 'x'"):
        require_tools((), ("x",), ())
    with pytest.raises(ConfigError, match="Expected each name once for --loggers"):
        require_tools(("csv", "csv"), (), ())
    monkeypatch.setattr(registry, "find_spec", lambda _: None)
    with pytest.raises(ConfigError, match=r"--loggers wandb needs wandb, .*; pip install 'legpush\[wandb\]'"):
        require_tools(("wandb",), (), ())
