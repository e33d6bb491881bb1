"""Evaluation as a program: `legpush evaluate POLICY`."""

import re
import shlex
import sys
import threading
from datetime import datetime
from pathlib import Path
from typing import Final

import msgspec
import tyro
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from agent_proc.evaluation.episodes import evaluate, summarize
from agent_proc.evaluation.sweep import make_sweep
from agent_proc.policies.registry import make_policy
from agent_proc.simulators import simulators
from legpush.errors import ConfigError, StopRequestedError
from legpush.files import write_whole
from legpush.options.learning import EvaluateOptions
from legpush.runs.folder import LOGS, own_folder
from legpush.scenarios.file import load_scenario
from legpush.service import run_program, stop_on_signals
from legpush.versions import installed_versions

ROWS_FILE: Final = "episodes.csv"
PARQUET_FILE: Final = "episodes.parquet"
SUMMARY_FILE: Final = "summary.json"
PLOT_FILE: Final = "evaluation.png"


def main() -> int:
    """Parse the command line and evaluate; returns the exit code."""
    return run_program("evaluate", lambda: run(tyro.cli(EvaluateOptions, prog="legpush evaluate"), Console()))


def run(options: EvaluateOptions, console: Console) -> int:
    """Evaluate the policy and write rows, summary and plot; returns the exit code.

    Raises:
        ConfigError: An option cannot be used.
        StopRequestedError: The user interrupted it; nothing is written.
    """
    from agent_proc.evaluation.plot import save_plot
    from agent_proc.evaluation.table import as_csv, table, write_parquet

    scenario = load_scenario(options.scenario)
    sweep = make_sweep(scenario, options.sweep, grid=options.grid)
    policy = make_policy(options.policy, options.normalizer, trust_file=options.trust_policy_file)
    folder = options.out or _default_folder(options.policy)
    if folder.exists() and any(folder.iterdir()):
        raise ConfigError(f"Expected a new or empty folder for --out, got {folder}")
    folder.mkdir(parents=True, exist_ok=True)
    seeds = range(options.first_seed, options.first_seed + options.episodes)
    stop, links_stop = stop_on_signals(), threading.Event()
    with (
        own_folder(folder),
        simulators(options, folder / LOGS, links_stop, kind="evaluate", folder=folder) as worlds,
        _bar(console) as bar,
    ):
        task = bar.add_task("evaluating", total=len(sweep.cases) * len(seeds))
        try:
            rows = evaluate(worlds, sweep.cases, seeds, policy, on_row=lambda _: bar.advance(task), stop=stop)
        except StopRequestedError as error:
            raise StopRequestedError("interrupted: nothing was written") from error
        finally:
            links_stop.set()
    summaries = summarize(rows)
    record = {
        "command": shlex.join(["legpush", "evaluate", *sys.argv[1:]]),
        "policy": options.policy,
        "scenario": scenario,
        "first_seed": options.first_seed,
        "episodes": options.episodes,
        "versions": installed_versions(),
        "cases": summaries,
    }
    columns = table(rows, sweep)
    write_whole(folder / ROWS_FILE, as_csv(columns).encode())
    write_parquet(columns, folder / PARQUET_FILE)
    write_whole(folder / SUMMARY_FILE, msgspec.json.format(msgspec.json.encode(record), indent=1) + b"\n")
    save_plot(rows, sweep, options.policy, folder / PLOT_FILE)
    for case, summary in summaries.items():
        console.print(Text(f"{case or scenario.name}: {summary}"), soft_wrap=True)
    console.print(Text(f"written to {folder}"), soft_wrap=True)
    return 0


def _default_folder(policy: str) -> Path:
    name = re.sub(r"[^A-Za-z0-9_-]+", "-", policy).strip("-")[-64:]
    return Path("runs") / f"{datetime.now().astimezone():%Y%m%d-%H%M%S}-evaluate-{name}"


def _bar(console: Console) -> Progress:
    """A bar with the number of finished episodes and the remaining time."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, TimeRemainingColumn(), console=console, disable=not console.is_terminal)
