"""The trials of a tuning, in a database of Optuna: asked in batches, judged seed by seed, given up early.

A trial is reported after each of its training seeds, and one that is worse than others then gets no further seed. Whole
batches are asked at a time, and the sampler of each trial has a seed of its own. So the trials do not depend on the
number of workers, and a tuning that was interrupted goes on as if it had not been.
"""

import json
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import optuna
from optuna.pruners import BasePruner, MedianPruner, NopPruner
from optuna.samplers import BaseSampler, RandomSampler, TPESampler
from optuna.trial import FrozenTrial, Trial, TrialState
from sqlalchemy import URL

from agent_proc.studies.tuning.space import Space, Value

DATABASE_FILE: Final = "optuna.db"
STUDY_NAME: Final = "tuning"
Pruner = Literal["median", "none"]
Sampler = Literal["tpe", "random"]
Judge = Callable[[Mapping[int, Mapping[str, Value]], int], Mapping[int, float]]
"""Trains each trial, by its number, with the seed at a place, and returns the loss of each."""


@dataclass(frozen=True, kw_only=True)
class TrialEnd:
    """A trial that has ended."""

    number: int
    values: Mapping[str, Value]
    loss: float
    """Mean over the seeds that it was trained with."""
    n_seeds: int
    pruned: bool
    """Whether it was given up before its last seed."""


class Trials:
    """The trials in the database of a folder."""

    def __init__(
        self, folder: Path, space: Space, *, seed: int, batch: int, n_seeds: int, pruner: Pruner, sampler: Sampler
    ) -> None:
        """Open the database, or make it.

        Args:
            folder: Of the tuning.
            space: Fields and values.
            seed: Of all samplers.
            batch: Trials that are asked at a time.
            n_seeds: Training seeds of a whole trial.
            pruner: When a trial is given up.
            sampler: How values are chosen.
        """
        optuna.logging.set_verbosity(logging.WARNING)
        self._space = space
        self._seed = seed
        self._batch = batch
        self._n_seeds = n_seeds
        self._sampler: Sampler = sampler
        url = URL.create("sqlite", database=str((folder / DATABASE_FILE).absolute()))
        self._study = optuna.create_study(
            storage=url.render_as_string(hide_password=False),
            study_name=STUDY_NAME,
            direction="minimize",
            pruner=_pruner(pruner, batch),
            load_if_exists=True,
        )

    @property
    def ended(self) -> list[TrialEnd]:
        """All trials that have ended, in their order."""
        return [self._end(trial) for trial in self._study.trials if trial.state.is_finished()]

    @property
    def best(self) -> TrialEnd | None:
        """The best of the trials that had all seeds; None before one had."""
        whole = [end for end in self.ended if not end.pruned]
        return min(whole, key=lambda end: end.loss, default=None)

    def run(self, n_trials: int, judge: Judge, on_end: Callable[[TrialEnd], None] = lambda _: None) -> None:
        """Go on until there are `n_trials` that have ended; what `judge` raises passes through."""
        for first in range(0, n_trials, self._batch):
            numbers = range(first, min(first + self._batch, n_trials))
            trials = [self._trial(number) for number in numbers]
            if all(self._frozen(number).state.is_finished() for number in numbers):
                continue
            values = {trial.number: self._suggested(trial) for trial in trials}
            for place in range(self._n_seeds):
                self._one_seed(trials, values, place, judge, on_end)

    def _one_seed(
        self,
        trials: Sequence[Trial],
        values: Mapping[int, Mapping[str, Value]],
        place: int,
        judge: Judge,
        on_end: Callable[[TrialEnd], None],
    ) -> None:
        """Train the trials of a batch that are not given up with one more seed."""
        alive = [trial for trial in trials if _is_alive(self._frozen(trial.number), place)]
        if not alive or all(self._frozen(trial.number).state.is_finished() for trial in alive):
            return
        losses = judge({trial.number: values[trial.number] for trial in alive}, place)
        for trial in alive:
            frozen = self._frozen(trial.number)
            if place not in frozen.intermediate_values:
                before = place * frozen.intermediate_values[place - 1] if place else 0.0
                trial.report((before + losses[trial.number]) / (place + 1), place)
        for trial in alive:
            if self._frozen(trial.number).state.is_finished():
                continue
            if place == self._n_seeds - 1:
                self._study.tell(trial, self._frozen(trial.number).intermediate_values[place])
            elif trial.should_prune():
                self._study.tell(trial, state=TrialState.PRUNED)
            else:
                continue
            on_end(self._end(self._frozen(trial.number)))

    def _trial(self, number: int) -> Trial:
        """The trial with this number; asked if there is none yet."""
        if number < len(self._study.trials):
            return Trial(self._study, self._frozen(number)._trial_id)
        self._study.sampler = _sampler(self._sampler, self._seed, number)
        if number == 0 and (own := self._space.values_of_profile()) is not None:
            self._study.enqueue_trial({path: _stored(self._space, path, value) for path, value in own.items()})
        trial = self._study.ask()
        self._suggested(trial)
        return trial

    def _suggested(self, trial: Trial) -> dict[str, Value]:
        """The values of a trial; values that were chosen before stay."""
        found: dict[str, Value] = {}
        for path, parameter in self._space.parameters.items():
            low, high = parameter.low, parameter.high
            if parameter.choices is not None:
                found[path] = json.loads(trial.suggest_categorical(path, [json.dumps(c) for c in parameter.choices]))
            elif isinstance(low, int) and isinstance(high, int):
                found[path] = trial.suggest_int(path, low, high, log=parameter.log)
            elif low is not None and high is not None:
                found[path] = trial.suggest_float(path, low, high, log=parameter.log)
        return found

    def _frozen(self, number: int) -> FrozenTrial:
        return self._study.get_trials(deepcopy=False)[number]

    def _end(self, trial: FrozenTrial) -> TrialEnd:
        last = max(trial.intermediate_values)
        values = {
            path: json.loads(value) if self._space.parameters[path].choices is not None else value
            for path, value in trial.params.items()
        }
        return TrialEnd(
            number=trial.number,
            values=values,
            loss=trial.intermediate_values[last],
            n_seeds=last + 1,
            pruned=trial.state is TrialState.PRUNED,
        )


def _is_alive(trial: FrozenTrial, place: int) -> bool:
    """Whether the trial is to be trained with the seed at this place, or was."""
    if place == 0:
        return True
    given_up = trial.state is TrialState.PRUNED and max(trial.intermediate_values) == place - 1
    return place - 1 in trial.intermediate_values and not given_up


def _stored(space: Space, path: str, value: Value) -> bool | int | float | str:
    """A value as the database has it: one of several choices as JSON."""
    if space.parameters[path].choices is not None or isinstance(value, list):
        return json.dumps(value)
    return value


def _sampler(name: Sampler, seed: int, number: int) -> BaseSampler:
    own = (seed * 1_000_003 + number) % 2**32
    return RandomSampler(seed=own) if name == "random" else TPESampler(seed=own, constant_liar=True)


def _pruner(name: Pruner, batch: int) -> BasePruner:
    return NopPruner() if name == "none" else MedianPruner(n_startup_trials=batch)
