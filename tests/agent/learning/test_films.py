from pathlib import Path

import numpy as np
from msgspec.structs import replace

from agent_proc.learning.films import FILMS, VIDEO_FILE, is_due, keep_episode, unfilmed
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.policies.registry import make_policy
from agent_proc.task.file import load_task
from legpush.history.steps import StepRecord, read_episode
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Push, Reset
from sim_proc.simulator import Simulator
from tests.agent.learning.small_training import small_profile


def plan_of(film_every: int | None = None, *, film_last: bool = False) -> TrainingPlan:
    task = load_task("tuned")
    scenario = replace(task.scenario, mission=replace(task.scenario.mission, max_push_cycles=2))
    return TrainingPlan(
        profile=small_profile(),
        task=replace(task, scenario=scenario),
        seed=1,
        n_simulators=1,
        command="",
        versions={},
        film_every=film_every,
        film_last=film_last,
    )


def test_every_nth_evaluation_and_the_last_one_are_due() -> None:
    assert [is_due(plan_of(2), n, last=n == 5) for n in range(1, 6)] == [False, True, False, True, False]
    assert [is_due(plan_of(film_last=True), n, last=n == 5) for n in range(1, 6)] == [False] * 4 + [True]
    assert not is_due(plan_of(), 1, last=True)


def test_an_episode_is_kept_with_traces_and_waits_for_its_film(tmp_path: Path) -> None:
    for _ in range(2):  # A training that was interrupted behind an evaluation makes it again.
        place = keep_episode(plan_of(1), tmp_path, 64, make_policy("scripted"), LocalWorld(Simulator()))
    assert place == tmp_path / FILMS / "step-00000064"
    assert unfilmed(tmp_path) == [place]
    steps = [step for step in read_episode(next(place.glob("*.journal"))) if isinstance(step, StepRecord)]
    assert [type(step.motion) for step in steps] == [Reset, Push, Push]
    assert steps[1].outcome.trace is not None
    assert np.isfinite(steps[1].outcome.trace.qpos).all()
    (place / VIDEO_FILE).touch()
    assert unfilmed(tmp_path) == []
