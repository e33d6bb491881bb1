"""Comparisons as a program: `legpush compare`."""

import shlex
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import msgspec
import tomli_w
from rich.console import Console
from rich.text import Text

from agent_proc.evaluation.starts import require_held_out
from agent_proc.evaluation.sweep import make_sweep, parse_sweep
from agent_proc.rivals.blind import Action
from agent_proc.studies.comparison.constants import best_constant
from agent_proc.studies.comparison.contestants import (
    CONSTANT,
    Contestant,
    cards_of,
    chosen_on,
    find_contestants,
    task_source,
)
from agent_proc.studies.comparison.outcome import Outcome, make_outcome
from agent_proc.studies.comparison.picture import save_picture
from agent_proc.studies.comparison.tables import as_csv, as_json, as_text, entry_cells, kinds, versus_cells
from agent_proc.studies.push_cell import task_of
from agent_proc.studies.rows_of_study import rows_of_study
from agent_proc.task.file import DEFAULT_TASK, load_task, scenario_of_task
from agent_proc.task.rooms import refuse_missions
from agent_proc.task.worlds import drawn_scenarios, require_known
from legpush.errors import ConfigError
from legpush.files import make_folder, write_whole
from legpush.options.checks import require_writable_folder
from legpush.options.learning_tools import SCENARIO, CompareOptions, dated
from legpush.options.scenarios import changed_scenario
from legpush.output.reply import document
from legpush.scenarios.changes import parse_changes
from legpush.scene.scenario import Goal, Scenario
from legpush.service import run_command, stop_on_signals
from legpush.study.carry_out import Orders
from legpush.study.engines.local import LocalEngine
from legpush.study.engines.staying import staying
from legpush.study.file import Study, read_study
from legpush.study.progress import shown

NAME: Final = "comparison"


def main() -> int:
    """Parse the command line and compare; returns the exit code."""
    return run_command("compare", CompareOptions, lambda options: compare(options, Console()))


def compare(options: CompareOptions, console: Console) -> int:
    """Run the comparison, or go on with it, print and write what comes out; returns the exit code.

    Raises:
        ConfigError: An option cannot be used, or a start was used to choose something.
        PolicyError: There is no such policy.
        ScenarioError: The scenario or a sweep cannot be used.
        StopRequestedError: Interrupted by a signal; what is done is kept.
        LegpushError: A cell failed.
    """
    named = options.task
    options = replace(options, scenario=_scenario(options), domain=named or options.domain, task=None)
    contestants = find_contestants(options.runs, options.policy)
    labels = [each.label for each in contestants]
    if options.against not in labels:
        raise ConfigError(f"Expected one of {', '.join(labels)} for --against, got {options.against}")
    seeds = range(options.seed, options.seed + options.episodes)
    require_held_out(seeds, chosen_on(cards_of(contestants)), "--seed")
    scenario = changed_scenario(_scenario(options), options.changes)
    goal = _goal(options, scenario)
    require_known(options.world, partial(_episodes, options, options.sweep))
    require_known(options.search_world, partial(_episodes, options, ()), "--search-world")
    folder = options.out or dated("compare")
    require_writable_folder(folder, "--out")
    source = named or task_source(contestants) or DEFAULT_TASK
    source = str(Path(source).absolute()) if Path(source).is_file() else source
    task = task_of(source, scenario)
    words = [*sys.argv[1:], *([] if options.out else ["--out", str(folder)])]
    make_folder(folder, private=options.out is None)
    with staying(LocalEngine(options.n_workers)) as engine:
        orders = Orders(
            engine=lambda _: engine,
            stop=stop_on_signals(),
            again=shlex.join(["legpush", "compare", *words]),
            retry_failed=True,
            shown=partial(shown, console),
        )
        searched = {**_settings(options, source), "world": options.search_world}
        constant = best_constant(task, searched, goal, folder / "constants", partial(rows_of_study, orders=orders))
        study = _study(options, contestants, source, constant)
        rows = rows_of_study(study, folder / "study", orders)
    fields = [field for field, _ in map(parse_sweep, options.sweep)]
    outcome = make_outcome(rows, contestants, options.against, constant, fields, goal)
    _write(outcome, options, goal, folder, console)
    return 0


def _scenario(options: CompareOptions) -> str:
    """The name or the path of the scenario (`ConfigError` if there is no such task)."""
    return options.scenario or (SCENARIO if options.task is None else scenario_of_task(options.task))


def _episodes(options: CompareOptions, sweep: Sequence[str], scenario: str | None) -> Iterator[Scenario]:
    """Scenarios of some episodes, in this scenario or that of the options."""
    changed = changed_scenario(scenario or _scenario(options), options.changes)
    for case in make_sweep(changed, sweep, grid=True).cases.values():
        if options.domain is None:
            yield case
        else:
            yield from drawn_scenarios(load_task(options.domain, case).domain, case)


def _goal(options: CompareOptions, scenario: Scenario) -> Goal:
    """The goal of the scenario, with the tolerances of the domain.

    Raises:
        ConfigError: There is no such domain, or its episodes are whole missions.
    """
    if options.domain is None:
        return scenario.goal
    task = load_task(options.domain, scenario)
    refuse_missions(task.random_room)
    return task.scenario.goal


def _settings(options: CompareOptions, task: str) -> dict[str, Any]:
    """What all cells have in common, as a study file says it from any directory."""
    name = _scenario(options)
    scenario = str(Path(name).absolute()) if Path(name).is_file() else name
    domain = options.domain
    if domain is not None and Path(domain).is_file():
        domain = str(Path(domain).absolute())
    given = {} if domain is None else {"domain": domain}
    return {"scenario": scenario, "task": task, **given, **parse_changes(options.changes)}


def _study(options: CompareOptions, contestants: list[Contestant], task: str, constant: Action) -> Study:
    """Every policy on every start of every case."""
    policies = [policy for contestant in contestants for policy in contestant.policies]
    actions = [list(map(float, constant)) if policy == CONSTANT else [] for policy in policies]
    swept: dict[str, Any] = {field: list(values) for field, values in map(parse_sweep, options.sweep)}
    file = {
        "name": NAME,
        "cell": "push",
        "settings": {**_settings(options, task), "world": options.world},
        "together": [{"policy": policies, "action": actions}],
        "axes": {**swept, "seed": {"first": options.seed, "n": options.episodes}},
    }
    return read_study(tomli_w.dumps(file), "the comparison", allowed_policies=policies)


def _write(outcome: Outcome, options: CompareOptions, goal: Goal, folder: Path, console: Console) -> None:
    """Print the tables, or JSON, and write all files.

    Raises:
        DiskError: A file cannot be written.
    """
    n = options.episodes
    about = {
        "scenario": options.scenario,
        "changes": options.changes,
        "domain": options.domain,
        "sweep": options.sweep,
        "world": options.world,
        "search_world": options.search_world,
        "first_seed": options.seed,
        "episodes": n,
        "policy": options.policy,
        "position_tolerance_m": goal.position_tolerance_m,
        "angle_tolerance_deg": goal.angle_tolerance_deg,
    }
    text = as_json(outcome, about)
    write_whole(folder / f"{NAME}.json", text)
    write_whole(folder / f"{NAME}.csv", as_csv(outcome).encode())
    title = f"{options.scenario}, world {options.world}, {n} starts" + (" of each case" if options.sweep else "")
    save_picture(outcome, f"{title}; 95 % intervals", folder / f"{NAME}.png")
    document(msgspec.json.decode(text))
    action = ", ".join(f"{value:g}" for value in outcome.constant)
    notes = (
        "",
        f"constant: the action ({action}), the best of a grid in the world {options.search_world}, on other starts",
        "loss: the larger error over its tolerance; 10 for an episode that the policy did not end by itself",
        f"intervals: {'; '.join(kinds(outcome))}",
        f"wrote {folder / NAME}.json, .csv and .png",
    )
    for block in (as_text(entry_cells(outcome)), "", as_text(versus_cells(outcome)), *notes):
        console.print(Text(block), soft_wrap=True)
