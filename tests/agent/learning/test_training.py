"""Trainings that are interrupted, resumed, and run out of disk."""

import os
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
import torch

from agent_proc.frames.push_view import push_view
from agent_proc.learning.checkpoint import CHECKPOINT_FILE, CheckpointError, load_checkpoint
from agent_proc.learning.training import BEST, LAST, Training
from agent_proc.learning.training_plan import Progress, TrainingResult
from agent_proc.policies.folder import read_card
from agent_proc.policies.learned import load_learned
from agent_proc.profiles.profile import AnyProfile, PpoProfile, load_profile
from agent_proc.task.file import load_task
from legpush.errors import PeerError
from legpush.files import DiskError
from tests.agent.fake_world import make_state, scenario_at_station
from tests.agent.learning.small_training import make_training, small_profile, weights

PAPER = ("paper-text", "release", "paper-learns")


@dataclass(frozen=True, kw_only=True)
class TwoTrainings:
    """One that ran through, and one that was interrupted and went on."""

    whole: Training
    expected: TrainingResult
    first: TrainingResult
    second: Training
    result: TrainingResult


def train_twice(folder: Path, profile: AnyProfile, is_time_to_stop: Callable[[Progress], bool]) -> TwoTrainings:
    """In `whole` and `parts` of the folder."""
    whole = make_training(folder / "whole", profile)
    expected = whole.run()
    stop = threading.Event()

    def interrupt(progress: Progress) -> None:
        if is_time_to_stop(progress):
            stop.set()

    (folder / "parts").mkdir()
    first = make_training(folder / "parts", profile, on_progress=interrupt, stop=stop).run()
    second = make_training(folder / "parts", profile)
    second.resume()
    return TwoTrainings(whole=whole, expected=expected, first=first, second=second, result=second.run())


@pytest.mark.parametrize(
    ("name", "stop_at"),
    [("tuned", 70), ("tuned", 96), ("sac", 70), ("td3", 101), *((name, 70) for name in PAPER)],
)
def test_an_interrupted_training_ends_with_the_weights_of_an_uninterrupted_one(
    tmp_path: Path, name: str, stop_at: int
) -> None:
    profile = small_profile(name)

    both = train_twice(tmp_path, profile, lambda progress: progress.step >= stop_at)

    assert not both.first.finished
    assert 0 < both.first.step < profile.steps
    assert both.result == both.expected
    assert both.result.finished
    assert weights(both.second.learner.model) == weights(both.whole.learner.model)
    ends = [load_checkpoint(tmp_path / part / CHECKPOINT_FILE) for part in ("whole", "parts")]
    assert ends[0].curve == ends[1].curve
    assert len(ends[0].curve) > 5
    assert ends[0].checks == ends[1].checks
    assert len(ends[0].checks) >= 2
    assert ends[0].visits == ends[1].visits
    assert sum(ends[0].visits.beside) == sum(ends[0].visits.turned) > profile.steps
    assert read_card(tmp_path / "parts" / LAST).reach == ends[0].visits.reach


@pytest.mark.parametrize("name", ["tuned", "sac"])
@pytest.mark.parametrize("step", [64, 160])
def test_a_training_is_interrupted_amid_an_evaluation_which_is_then_done_again(
    tmp_path: Path, name: str, step: int
) -> None:
    both = train_twice(
        tmp_path,
        small_profile(name),
        lambda progress: progress.doing == "evaluating, episode 0 of 2" and progress.step >= step,
    )

    assert not both.first.finished
    assert step <= both.first.step < step + 32
    assert both.result == both.expected
    assert weights(both.second.learner.model) == weights(both.whole.learner.model)


def test_exploration_narrows_as_the_profile_says(tmp_path: Path) -> None:
    profile = small_profile()
    assert isinstance(profile, PpoProfile)
    assert profile.settings.log_std_end is not None
    spreads: dict[int, float] = {}

    def note(progress: Progress) -> None:
        spread = training.learner.model.policy.log_std
        assert isinstance(spread, torch.Tensor)
        spreads.setdefault(progress.step, spread[0].item())

    training = make_training(tmp_path, profile, on_progress=note)

    training.run()

    first, last = profile.settings.log_std_init, profile.settings.log_std_end
    begun = {step: (step - 2) // 32 * 32 / profile.steps for step in spreads if 0 < step <= profile.steps}
    assert len(set(begun.values())) == 5
    for step, done in begun.items():
        assert spreads[step] == pytest.approx(first + done * (last - first))


def test_learning_changes_the_weights(tmp_path: Path) -> None:
    training = make_training(tmp_path, small_profile())
    before = weights(training.learner.model)

    training.run()

    assert weights(training.learner.model) != before


def test_the_best_and_the_last_policy_can_be_used_afterwards(tmp_path: Path) -> None:
    training = make_training(tmp_path, small_profile())

    result = training.run()

    best, last = (load_learned(str(tmp_path / name)).card for name in (BEST, LAST))
    assert result.best is not None
    assert best.check == result.best
    assert last.steps == result.step
    assert last.curve
    assert (tmp_path / "tensorboard").is_dir()


@pytest.mark.parametrize("name", [*PAPER, "tuned", "sac", "td3"])
def test_the_policy_of_every_profile_has_its_task_on_its_card_and_pushes(tmp_path: Path, name: str) -> None:
    make_training(tmp_path, small_profile(name, steps=32, evaluate_every=32)).run()
    policy = load_learned(str(tmp_path / LAST))
    scenario = scenario_at_station()

    assert policy.card.task.ending == load_task(load_profile(name).task).ending
    assert policy.decide(push_view(make_state(scenario.start.pose(), scenario.box.pose.pose()), scenario)) is not None
    assert policy.decide(push_view(make_state(scenario.start.pose(), scenario.goal.pose.pose()), scenario)) is None


def test_a_full_disk_leaves_the_previous_checkpoint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / CHECKPOINT_FILE
    n_written = 0

    def sync(descriptor: int) -> None:
        nonlocal n_written
        n_written += 1
        if n_written > 1:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", sync)
    with pytest.raises(DiskError, match=r"checkpoint: expected to write .*No space left.*previous one is untouched"):
        make_training(tmp_path, small_profile()).run()
    monkeypatch.undo()

    assert n_written > 1
    assert [entry.name for entry in tmp_path.iterdir() if entry.name.endswith(".part")] == []
    assert load_checkpoint(path).step == 32
    resumed = make_training(tmp_path, small_profile())
    resumed.resume()
    assert resumed.run().finished


def test_a_simulator_that_is_lost_leaves_a_checkpoint_of_the_last_rollout(tmp_path: Path) -> None:
    def lose(progress: Progress) -> None:
        if progress.step >= 50:
            raise PeerError("sim/sim0 is dead")

    with pytest.raises(PeerError, match="is dead"):
        make_training(tmp_path, small_profile(checkpoint_every=1000), on_progress=lose).run()

    assert load_checkpoint(tmp_path / CHECKPOINT_FILE).step == 32


def test_a_checkpoint_of_another_format_is_not_resumed_from(tmp_path: Path) -> None:
    (tmp_path / CHECKPOINT_FILE).write_bytes(b"legpush training checkpoint 1\n")

    with pytest.raises(CheckpointError, match="got format 1"):
        make_training(tmp_path, small_profile()).resume()


def test_without_a_checkpoint_there_is_nothing_to_resume(tmp_path: Path) -> None:
    with pytest.raises(CheckpointError, match=r"expected the checkpoint of a training \(No such file"):
        make_training(tmp_path, small_profile()).resume()
