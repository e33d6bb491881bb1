"""What an evaluation judges a policy on: the task that it was trained on, another one, or a scenario alone."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

from msgspec.structs import asdict, replace

from agent_proc.evaluation.starts import starts_of
from agent_proc.evaluation.sweep import value_at
from agent_proc.policies.folder import policy_path, read_card
from agent_proc.task.config import TaskConfig
from agent_proc.task.file import DEFAULT_TASK, load_task
from agent_proc.task.rooms import refuse_missions
from legpush.errors import ConfigError
from legpush.options.scenarios import with_changes
from legpush.policy_names import policy_kind
from legpush.scenarios.changes import parse_changes
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario

N_LOOKED_AT: Final = 3
"""Starts that are looked at to find what all of them draw."""


@dataclass(frozen=True, kw_only=True)
class EvaluationTask:
    """Scenario and starts of an evaluation."""

    scenario: Scenario
    """With all changes."""
    drawn: Callable[[Scenario, int], Scenario]
    """What a start, by its seed, has in place of the scenario of its case."""
    told: str
    """What it judges on, for people."""

    def starts(self, cases: Iterable[Scenario], seeds: Iterable[int]) -> list[Scenario]:
        """Return the scenarios of the starts of all cases."""
        return [self.drawn(case, seed) for seed in seeds for case in cases]

    def require_kept(self, fields: Iterable[str], cases: Iterable[Scenario], first_seed: int, flag: str) -> None:
        """Require fields that the starts leave as they are.

        Raises:
            ConfigError: A start draws one of them, so that its value in `cases` would change nothing.
        """
        seeds = range(first_seed, first_seed + N_LOOKED_AT)
        starts = [(case, self.drawn(case, seed)) for case in cases for seed in seeds]
        for field in fields:
            if any(value_at(case, field) != value_at(start, field) for case, start in starts):
                raise ConfigError(
                    f"Expected fields that the starts leave as they are for {flag}, got {field}, which each start of "
                    "the task draws; --task tuned has starts that draw no more than their offsets"
                )


def evaluation_task(
    policy: str, task: str | None, scenario: str | None, changes: tuple[str, ...] = (), first_seed: int = 0
) -> EvaluationTask:
    """Find what to judge a policy on.

    Without `task`, it is that of the card if `policy` is the folder of one, else the default task, whose starts draw
    nothing. A `scenario` replaces that of the task.

    Raises:
        ConfigError: There is no such task, its episodes are missions, or its starts draw a field of `changes`.
        ScenarioError: The scenario or a change cannot be used.
        PolicyError: The card of the policy cannot be used.
    """
    given = None if scenario is None else load_scenario(scenario)
    if task is not None:
        found, name = load_task(task, given), f"the task {task}, in "
    elif policy_kind(policy) == "folder":
        found, name = _of_card(policy, given), "the task that it was trained on, in "
    else:
        found, name = load_task(DEFAULT_TASK, given), ""
    refuse_missions(found.random_room)
    told = f"{name}the scenario {found.scenario.name}"
    if found.evaluation == "domain":
        drawn = [field for field, value in asdict(found.domain).items() if value is not None]
        told += f"; each start draws {', '.join(drawn)}"
    made = EvaluationTask(scenario=with_changes(found.scenario, changes), drawn=starts_of(found), told=told)
    made.require_kept(parse_changes(changes), [made.scenario], first_seed, "--set")
    return made


def _of_card(policy: str, scenario: Scenario | None) -> TaskConfig:
    """The task that a policy was trained on, in a scenario with the tolerances of that task if it draws its goals."""
    task = read_card(policy_path(policy)).task
    if scenario is None:
        return task
    if task.evaluation == "domain":
        scenario = replace(scenario, goal=replace(task.scenario.goal, pose=scenario.goal.pose))
    return replace(task, scenario=scenario)
