"""The program of `legpush plan-check`: checks a planner and prints the findings."""

import sys
from contextlib import ExitStack

import msgspec
from rich.console import Console
from rich.text import Text

from legpush.bus.bus import Bus
from legpush.errors import one_line
from legpush.files import write_whole
from legpush.options.conformance import PlanCheckOptions, split_at_dashes
from legpush.output.reply import document
from legpush.runs.temporary import temporary_folder
from legpush.service import run_command, stop_on_signals
from planner_proc.conformance.bench import Bench
from planner_proc.conformance.checks import Finding, run_checks
from planner_proc.conformance.client import RUN, Client, PlannerProcess


def main() -> int:
    """Check a planner; returns the exit code: 0 all checks passed, 1 not all, 2 bad input, 130 interrupted."""
    flags, command = split_at_dashes(sys.argv[1:])
    return run_command("plan-check", PlanCheckOptions, lambda options: check(options, command, Console()), flags)


def check(options: PlanCheckOptions, command: tuple[str, ...], console: Console) -> int:
    """Start a planner, check it, and print the findings; returns 0 if all checks passed, else 1.

    Raises:
        ConfigError: No check has one of the texts of `--only` in its name.
        StopRequestedError: The check was interrupted.
    """
    stop = stop_on_signals()
    findings: list[Finding] = []
    with ExitStack() as stack:
        logs = stack.enter_context(temporary_folder("check-"))
        planner = stack.enter_context(PlannerProcess(command, logs / "planner.log", stop))
        clients = [Client(stack.enter_context(Bus(RUN, "agent", name, planner.endpoints)), planner) for name in "ab"]
        bench = Bench(planner=planner, client=clients[0], other=clients[1], deadline_s=options.deadline_s)
        for finding in run_checks(bench, options.only):
            findings.append(finding)
            mark, style = ("pass", "green") if finding.passed else ("FAIL", "bold red")
            note = f": {finding.reason}" if finding.reason else ""
            console.print(Text.assemble((mark, style), f"  {finding.name}{one_line(note)}"), soft_wrap=True)
    n_failed = sum(not finding.passed for finding in findings)
    verdict = "all checks passed" if not n_failed else f"{n_failed} of {len(findings)} checks failed"
    console.print(Text(verdict, style="bold"))
    report = {"command": command, "passed": n_failed == 0, "findings": findings}
    document(report)
    if options.out is not None:
        write_whole(options.out, msgspec.json.format(msgspec.json.encode(report), indent=1) + b"\n")
    return 1 if n_failed else 0
