import threading
from pathlib import Path

import pytest
from msgspec.structs import replace

from agent_proc.learning.plan_file import PROGRESS_FILE, read_plan
from agent_proc.learning.training import BEST, LAST, Training
from agent_proc.learning.training_plan import Progress, TrainingPlan
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.policies.folder import WEIGHTS_FILE
from agent_proc.studies.cell_parts import new_simulator
from agent_proc.studies.training_run import train_in
from agent_proc.task.file import load_task
from legpush.errors import ConfigError
from legpush.lockstep.local import LocalWorld
from tests.agent.learning.small_training import small_profile


def plan_of(steps: int = 96) -> TrainingPlan:
    profile = small_profile(steps=steps, evaluate_every=96, evaluation_episodes=1)
    task = load_task(profile.task, max_steps=8)
    scenario = replace(task.scenario, mission=replace(task.scenario.mission, max_push_cycles=4))
    task = replace(task, scenario=scenario)
    return TrainingPlan(profile=profile, task=task, seed=3, n_simulators=2, command="study", versions={}, world="map")


def worlds() -> list[LocalWorld]:
    return [LocalWorld(new_simulator("map")) for _ in range(2)]


def weights(folder: Path) -> bytes:
    return (folder / LAST / WEIGHTS_FILE).read_bytes()


def test_an_interrupted_training_goes_on_in_its_folder_to_the_same_weights(tmp_path: Path) -> None:
    plan, stop = plan_of(), threading.Event()
    check = train_in(tmp_path / "whole", plan, worlds())
    assert (tmp_path / "whole" / PROGRESS_FILE).read_text() == "100\n"

    cut = tmp_path / "cut"
    cut.mkdir()

    def interrupt(progress: Progress) -> None:
        if progress.step >= 50:
            stop.set()

    own = worlds()
    env = PushVecEnv(plan.task, own)
    assert not Training(plan, cut, env, own, stop=stop, on_progress=interrupt).run().finished
    env.close()

    # The plan was not written yet, as if the process had been killed before; it is written now.
    assert train_in(cut, plan, worlds()) == check
    assert read_plan(cut) == plan
    assert weights(cut) == weights(tmp_path / "whole")
    assert train_in(cut, plan, worlds()) == check, "a training that is done stays as it is"
    assert (cut / BEST).is_dir()


def test_another_training_in_the_folder_is_refused(tmp_path: Path) -> None:
    train_in(tmp_path / "a", plan_of(steps=32), worlds())
    with pytest.raises(ConfigError, match=r"expected the folder of this training, got one with another config\.json"):
        train_in(tmp_path / "a", plan_of(steps=64), worlds())
