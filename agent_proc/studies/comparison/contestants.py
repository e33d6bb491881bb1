"""Who takes part in a comparison: trainings of several seeds, single ones, policies, and the dumbest rivals."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from agent_proc.learning.plan_file import CONFIG_FILE
from agent_proc.policies.card import CARD_FILE, Card
from agent_proc.policies.digest import policy_sha256
from agent_proc.policies.folder import read_card
from agent_proc.rivals.registry import DUMBEST, RIVALS
from agent_proc.studies.seed_trainings import has_seeds, seed_folders
from legpush.errors import ConfigError

Which = Literal["best", "last"]
CONSTANT: Final = "constant"


@dataclass(frozen=True, kw_only=True)
class Contestant:
    """One line of the comparison."""

    label: str
    policies: tuple[str, ...]
    """One for each training, or a single one: names, or absolute paths of policy folders."""
    seeds: tuple[int, ...] = ()
    """Seeds of the trainings."""
    is_rival: bool = False


def find_contestants(runs: Sequence[str], which: Which) -> list[Contestant]:
    """The trainings and policies at these paths or names, then the rivals.

    Raises:
        ConfigError: A training is not done, or something is given twice.
        PolicyError: There is no such policy.
    """
    found = [_contestant(run, which) for run in runs]
    names = [policy for contestant in found for policy in contestant.policies]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(f"Expected each policy once, got {twice[0]} twice")
    labels = [contestant.label for contestant in found]
    if twice := sorted({label for label in labels if labels.count(label) > 1}):
        raise ConfigError(f"Expected folders with different names, got {twice[0]} twice")
    return [*found, *(Contestant(label=name, policies=(name,), is_rival=True) for name in DUMBEST)]


def cards_of(contestants: Iterable[Contestant]) -> list[Card]:
    """The cards of all policies that are folders, in order."""
    policies = [policy for contestant in contestants if not contestant.is_rival for policy in contestant.policies]
    return [read_card(Path(policy)) for policy in policies if (Path(policy) / CARD_FILE).is_file()]


def task_source(contestants: Iterable[Contestant]) -> str | None:
    """The first policy folder: the rivals have the actions and the stop rule of its task; None if there is none."""
    policies = (policy for contestant in contestants if not contestant.is_rival for policy in contestant.policies)
    return next((policy for policy in policies if (Path(policy) / CARD_FILE).is_file()), None)


def chosen_on(cards: Iterable[Card]) -> Mapping[str, set[int]]:
    """Starts on which something about these policies was chosen, by what."""
    used: dict[str, set[int]] = {"the best policy of a training": set()}
    for card in cards:
        if card.check is not None:
            used["the best policy of a training"] |= set(card.check.seeds)
        if (tuned_on := card.profile.tuned_on) is not None:
            starts = range(tuned_on.first_start, tuned_on.first_start + tuned_on.n_starts)
            used.setdefault("the profile of a training", set()).update(starts)
    return used


def _contestant(run: str, which: Which) -> Contestant:
    path = Path(run)
    if run in DUMBEST:
        raise ConfigError(f"Expected trainings or policies, got {run}, which is in every comparison")
    if run in RIVALS:
        return Contestant(label=run, policies=(run,), is_rival=True)
    if has_seeds(path):
        folders = seed_folders(path)
        policies = tuple(_policy_of(folder, which) for folder in folders.values())
        return Contestant(label=path.resolve().name, policies=policies, seeds=tuple(folders))
    if (path / CONFIG_FILE).is_file():
        return Contestant(label=path.resolve().name, policies=(_policy_of(path, which),))
    policy_sha256(run)
    is_folder = (path / CARD_FILE).is_file()
    return Contestant(label=_short(path) if is_folder else run, policies=(str(path.absolute()) if is_folder else run,))


def _policy_of(training: Path, which: Which) -> str:
    """The policy of a training that is done.

    Raises:
        ConfigError: It is not.
    """
    if not (training / "last" / CARD_FILE).is_file():
        resumed = training.parent if has_seeds(training.parent) else training
        raise ConfigError(f"{training}: expected a training that is done; legpush train --resume {resumed} goes on")
    return str((training / which).absolute())


def _short(path: Path) -> str:
    """Name of a policy folder: with that of its training, for `best` and `last`."""
    resolved = path.resolve()
    return f"{resolved.parent.name}/{resolved.name}" if resolved.name in ("best", "last") else resolved.name
