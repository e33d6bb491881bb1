"""The trials of a tuning: the same ones with and without an interruption, and bad ones given up."""

from collections.abc import Mapping
from math import log
from pathlib import Path

import pytest

from agent_proc.profiles.profile import load_profile
from agent_proc.studies.tuning.space import Space, Value, load_space
from agent_proc.studies.tuning.trials import Pruner, TrialEnd, Trials

SPACE = """
[search."settings.learning_rate"]
low = 1e-4
high = 1e-2
log = true
[search."settings.n_epochs"]
low = 5
high = 30
[search."network.hidden"]
choices = [[32, 32], [64, 64]]
"""
N_SEEDS = 3


class KilledError(Exception):
    """As if the process had been killed."""


@pytest.fixture
def space(tmp_path: Path) -> Space:
    path = tmp_path / "space.toml"
    path.write_text(SPACE)
    return load_space(str(path), load_profile("tuned"))


def trials(folder: Path, space: Space, pruner: Pruner = "median") -> Trials:
    folder.mkdir(exist_ok=True)
    return Trials(folder, space, seed=1, batch=3, n_seeds=N_SEEDS, pruner=pruner, sampler="tpe")


def losses(values: Mapping[int, Mapping[str, Value]], place: int) -> dict[int, float]:
    """Least at a rate of 3e-3 with wide layers."""
    found = {}
    for number, each in values.items():
        rate, hidden = float(str(each["settings.learning_rate"])), each["network.hidden"]
        found[number] = abs(log(rate / 3e-3)) + (0.5 if hidden == [32, 32] else 0.0) + 0.01 * place
    return found


def test_an_interrupted_tuning_goes_on_to_the_same_trials(tmp_path: Path, space: Space) -> None:
    whole = trials(tmp_path / "whole", space)
    whole.run(9, losses)

    for n_calls in (0, 1, 4):
        left = n_calls

        def judge(values: Mapping[int, Mapping[str, Value]], place: int) -> dict[int, float]:
            nonlocal left
            if left == 0:
                raise KilledError
            left -= 1
            return losses(values, place)

        with pytest.raises(KilledError):
            trials(tmp_path / "cut", space).run(9, judge)
    again = trials(tmp_path / "cut", space)
    again.run(9, losses)
    assert again.ended == whole.ended
    assert len(again.ended) == 9
    assert again.best == whole.best


def test_bad_trials_are_given_up_early_and_the_first_one_is_the_profile_itself(tmp_path: Path, space: Space) -> None:
    told: list[TrialEnd] = []
    some = trials(tmp_path / "some", space)
    some.run(12, losses, told.append)
    ended = some.ended
    assert ended[0].values == space.values_of_profile()
    given_up = [end for end in ended if end.pruned]
    assert given_up
    assert all(end.n_seeds < N_SEEDS and end.number >= 3 for end in given_up)
    assert all(end.n_seeds == N_SEEDS for end in ended if not end.pruned)
    assert sorted(end.number for end in told) == list(range(12))
    best = some.best
    assert best is not None
    assert best.loss == min(end.loss for end in ended if not end.pruned) < ended[0].loss
    # The reported loss is the mean over the seeds.
    (alone,) = losses({0: best.values}, 0).values()
    assert best.loss == pytest.approx(alone + 0.01 * (0 + 1 + 2) / 3)


def test_without_a_pruner_every_trial_has_all_seeds(tmp_path: Path, space: Space) -> None:
    some = trials(tmp_path / "all", space, "none")
    some.run(6, losses)
    assert [end.n_seeds for end in some.ended] == [N_SEEDS] * 6
    some.run(7, losses)
    assert len(some.ended) == 7, "more trials can be added later"
