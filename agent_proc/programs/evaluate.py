"""Evaluation as a program: `legpush evaluate POLICY`."""

import re
import shlex
import sys
import threading
from dataclasses import asdict
from datetime import datetime
from hashlib import sha256
from importlib.metadata import version
from itertools import product
from pathlib import Path
from typing import Final

import msgspec
from rich.console import Console
from rich.text import Text

from agent_proc.evaluation.episodes import Row, evaluate, summarize
from agent_proc.evaluation.evaluation_task import EvaluationTask, evaluation_task
from agent_proc.evaluation.sweep import Sweep, make_sweep
from agent_proc.policies.digest import policy_sha256
from agent_proc.policies.policy import Policy
from agent_proc.policies.registry import make_policy
from agent_proc.simulators import simulators
from agent_proc.task.worlds import N_DRAWS, require_known
from legpush.errors import ConfigError, StopRequestedError
from legpush.files import make_folder, next_file, sha256_of, write_whole
from legpush.long_work.finished import open_finished
from legpush.long_work.progress import counted
from legpush.numerics.current import current
from legpush.options.checks import require_writable_folder
from legpush.options.learning import EvaluateOptions
from legpush.output.reply import document
from legpush.runs.folder import COMMAND_FILE, LOGS, own_folder
from legpush.scenarios.file import dump_scenario
from legpush.scene.scenario import Scenario
from legpush.service import run_command, stop_on_signals
from legpush.versions import installed_versions

ROWS_FILE: Final = "episodes.csv"
PARQUET_FILE: Final = "episodes.parquet"
SUMMARY_FILE: Final = "summary.json"
PLOT_FILE: Final = "evaluation.png"
FINISHED_FILE: Final = "finished.jsonl"
"""The finished episodes of an evaluation that is not."""


def main() -> int:
    """Parse the command line and evaluate; returns the exit code."""
    return run_command("evaluate", EvaluateOptions, lambda options: run(options, Console()))


def run(options: EvaluateOptions, console: Console) -> int:
    """Evaluate the policy and write rows, summary and plot; returns the exit code.

    Raises:
        ConfigError: An option cannot be used.
        PluginError: There is no such world.
        StopRequestedError: The user interrupted it; the finished episodes are kept.
    """
    from agent_proc.evaluation.plot import save_plot
    from agent_proc.evaluation.table import as_csv, table, write_parquet

    folder = options.out or _default_folder(options.policy)
    require_writable_folder(folder, "--out")
    policy = make_policy(options.policy, options.normalizer, trust_file=options.trust_policy_file)
    task = _task(options, options.scenario)
    scenario, sweep = task.scenario, _sweep(options, task)
    _require_unused(folder)
    require_known(options.world, lambda name: _first_starts(options, task if name is None else _task(options, name)))
    if options.dry_run:
        console.print(Text(f"judged on {task.told}"), soft_wrap=True)
        for case, changed in sweep.cases.items():
            console.print(Text(f"# {case or scenario.name}\n{dump_scenario(changed)}"), soft_wrap=True)
        seeds = [options.seed, options.seed + options.episodes - 1]
        document({"judged_on": task.told, "scenarios": sweep.cases, "seeds": seeds})
        return 0
    make_folder(folder, private=options.out is None)
    make_folder(folder / LOGS, private=True)
    with own_folder(folder):
        write_whole(folder / LOGS / COMMAND_FILE, f"{_again(options, folder)}\n".encode(), private=True)
        rows, n_others = _finish(options, task, sweep, policy, folder, console)
        summaries = summarize(rows)
        for case, summary in summaries.items():
            console.print(Text(f"{case or scenario.name}: {summary}"), soft_wrap=True)
        record = {
            "command": shlex.join(["legpush", "evaluate", *sys.argv[1:]]),
            "policy": options.policy,
            "world": options.world,
            "judged_on": task.told,
            "scenario": scenario,
            "first_seed": options.seed,
            "episodes": options.episodes,
            "versions": installed_versions(),
            "cases": summaries,
        }
        columns = table(rows, sweep)
        write_whole(folder / ROWS_FILE, as_csv(columns).encode())
        write_parquet(columns, folder / PARQUET_FILE)
        save_plot(rows, sweep, options.policy, folder / PLOT_FILE)
        text = msgspec.json.format(msgspec.json.encode(record), indent=1) + b"\n"
        write_whole(folder / SUMMARY_FILE, text, private=True)
        if not n_others:
            (folder / FINISHED_FILE).unlink()
    if n_others:
        console.print(Text(f"{n_others} other finished episodes stay in {FINISHED_FILE}, for later"), soft_wrap=True)
    console.print(Text(f"written to {folder}"), soft_wrap=True)
    document({"folder": folder, **record})
    return 0


def _task(options: EvaluateOptions, scenario: str | None) -> EvaluationTask:
    """What the policy is judged on, in a scenario."""
    return evaluation_task(options.policy, options.task, scenario, options.changes, options.seed)


def _sweep(options: EvaluateOptions, task: EvaluationTask) -> Sweep:
    """The cases of a task."""
    sweep = make_sweep(task.scenario, options.sweep, grid=options.grid)
    task.require_kept(sweep.fields, sweep.cases.values(), options.seed, "--sweep")
    return sweep


def _first_starts(options: EvaluateOptions, task: EvaluationTask) -> list[Scenario]:
    """Some starts of all cases."""
    n = min(options.episodes, N_DRAWS)
    return task.starts(_sweep(options, task).cases.values(), range(options.seed, options.seed + n))


def _finish(
    options: EvaluateOptions, task: EvaluationTask, sweep: Sweep, policy: Policy, folder: Path, console: Console
) -> tuple[list[Row], int]:
    """Run the episodes that are not finished yet; returns the rows of all, and how many finished ones are others.

    Raises:
        StopRequestedError: The user interrupted it; the finished episodes are kept.
    """
    seeds = range(options.seed, options.seed + options.episodes)
    total = len(sweep.cases) * len(seeds)
    stop, links_stop = stop_on_signals(), threading.Event()
    with open_finished(folder / FINISHED_FILE, _work(options, task)) as kept:
        before = {(row.case, row.seed): row for row in (Row(**fields) for fields in kept.parts.values())}
        planned = set(product(sweep.cases, seeds))
        n_done, n_others = len(before.keys() & planned), len(before.keys() - planned)
        if n_done:
            console.print(Text(f"{n_done} of {total} episodes are finished already"), soft_wrap=True)
        with simulators(options, folder / LOGS, links_stop, kind="evaluate", folder=folder) as worlds:
            console.print(Text(f"judged on {task.told}"), soft_wrap=True)
            with counted(console, "evaluating", total, "episodes", done=n_done) as advance:

                def on_row(row: Row) -> None:
                    kept.keep(f"{row.case} seed {row.seed}", asdict(row))
                    advance()

                try:
                    return evaluate(worlds, sweep.cases, seeds, policy, on_row, stop, before, task.drawn), n_others
                except StopRequestedError as error:
                    if (n_kept := len(kept.parts) - n_others) == 0:
                        raise StopRequestedError("interrupted: no episode was finished") from error
                    kept_words = f"interrupted: {n_kept} of {total} episodes are kept"
                    raise StopRequestedError(f"{kept_words}; to go on: {_again(options, folder)}") from error
                finally:
                    links_stop.set()


def _work(options: EvaluateOptions, task: EvaluationTask) -> dict[str, str]:
    """What decides about an episode besides its case and its seed."""
    normalizer = "" if options.normalizer is None else sha256_of([options.normalizer])
    scenario = msgspec.json.encode(task.scenario)
    return {
        "policy": options.policy,
        "policy_sha256": policy_sha256(options.policy),
        "normalizer_sha256": normalizer,
        "scenario_sha256": sha256(scenario).hexdigest(),
        "judged_on": task.told,
        "world": options.world,
        "legpush": version("legpush"),
        "numerics": current().name,
    }


def _again(options: EvaluateOptions, folder: Path) -> str:
    """The command that goes on in the folder."""
    words = [word if word != str(options.record) else str(next_file(Path(word))) for word in sys.argv[1:]]
    return shlex.join(["legpush", "evaluate", *words, *([] if options.out else ["--out", str(folder)])])


def _require_unused(folder: Path) -> None:
    """Require a folder that is new or empty, or in which this evaluation goes on.

    Raises:
        ConfigError: It is another one.
    """
    names = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    if names and FINISHED_FILE not in names and names != {LOGS}:
        raise ConfigError(f"Expected a new or empty folder for --out, or one with {FINISHED_FILE}, got {folder}")


def _default_folder(policy: str) -> Path:
    name = re.sub(r"[^A-Za-z0-9_-]+", "-", policy).strip("-")[-64:]
    return Path("runs") / f"{datetime.now().astimezone():%Y%m%d-%H%M%S}-evaluate-{name}"
