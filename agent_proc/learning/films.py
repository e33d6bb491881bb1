"""Episodes of evaluations that are to be filmed: a folder each, which `legpush render` films."""

import shutil
from collections.abc import Mapping
from pathlib import Path
from time import time
from typing import Final

from agent_proc.evaluation.episodes import run_episode
from agent_proc.evaluation.starts import FIRST_CHECK_SEED, starts_of
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.policies.policy import Policy
from legpush.history.entries import Acted, Observed, Opened
from legpush.history.journal import Journal
from legpush.lockstep.world import SteppingWorld
from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.stepping import Motion, Outcome

FILMS: Final = "films"
JOURNAL_FILE: Final = "episode-0000.journal"
"""As in the folder of a mission."""
VIDEO_FILE: Final = "mission.mp4"


def is_due(plan: TrainingPlan, n_checks: int, *, last: bool) -> bool:
    """Whether an episode of the evaluation with this number, from 1, is to be filmed."""
    every = plan.film_every is not None and n_checks % plan.film_every == 0
    return every or (plan.film_last and last)


def keep_episode(plan: TrainingPlan, folder: Path, step: int, policy: Policy, world: SteppingWorld) -> Path:
    """Push from the first start of the evaluations, with everything written down; returns the folder of the episode.

    Raises:
        DiskError: It cannot be written.
    """
    place = folder / FILMS / f"step-{step:08}"
    if place.exists():
        shutil.rmtree(place)
    place.mkdir(parents=True)
    opened = Opened(
        protocol=PROTOCOL_VERSION, run=place.name, seed=FIRST_CHECK_SEED, versions=plan.versions, began_unix_s=time()
    )
    with Journal(place / JOURNAL_FILE, opened) as journal:
        scenario = starts_of(plan.task)(plan.task.scenario, FIRST_CHECK_SEED)
        run_episode(_Written(world, journal), scenario, FIRST_CHECK_SEED, policy)
    return place


def unfilmed(folder: Path) -> list[Path]:
    """Folders of the episodes of a training that have no film yet, in the order of their steps."""
    found = sorted((folder / FILMS).glob("step-*"))
    return [place for place in found if (place / JOURNAL_FILE).is_file() and not (place / VIDEO_FILE).exists()]


class _Written:
    """A world whose motions and outcomes are written down."""

    def __init__(self, world: SteppingWorld, journal: Journal) -> None:
        self._world = world
        self._journal = journal

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Step as without it."""
        self._journal.append(Acted(motion=motion, with_trace=with_trace))
        outcome = self._world.step(motion, with_trace=with_trace)
        self._journal.append(Observed(outcome=outcome))
        return outcome

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        """Tell as without it."""
        self._world.tell_reward(terms)
