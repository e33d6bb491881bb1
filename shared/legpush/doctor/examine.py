"""Makes all checks, and tells what they found."""

import sys
from collections.abc import Iterator
from typing import Final

from rich.console import Console
from rich.text import Text

from legpush.doctor.finding import Finding, State
from legpush.doctor.machine import (
    folder_findings,
    numerics_finding,
    opengl_finding,
    resource_findings,
    socket_findings,
)
from legpush.doctor.packages import package_findings, python_finding
from legpush.errors import one_line
from legpush.output.reply import document

STYLES: Final[dict[State, str]] = {"ok": "green", "note": "yellow", "missing": "bold red"}


def examine() -> int:
    """Tell what this machine has; return 0 if a mission can run, else 1."""
    console, findings = Console(), []
    for finding in all_findings():
        findings.append(finding)
        _tell(finding, console)
    n_missing, n_notes = (sum(each.state == state for each in findings) for state in ("missing", "note"))
    words = "a mission cannot run here" if n_missing else "a mission can run here"
    console.print(Text(f"{words}; {n_notes} note{'s' * (n_notes != 1)}"), soft_wrap=True)
    document({"can_run": not n_missing, "findings": findings})
    sys.stdout.flush()
    return 1 if n_missing else 0


def all_findings() -> Iterator[Finding]:
    """Make the checks one after the other."""
    yield python_finding()
    yield from package_findings()
    yield numerics_finding()
    yield opengl_finding()
    yield from socket_findings()
    yield from folder_findings()
    yield from resource_findings()


def _tell(finding: Finding, console: Console) -> None:
    """Print a line about a finding, and one about what would change it."""
    mark = (f"{finding.state:<8}", STYLES[finding.state])
    console.print(Text.assemble(mark, f"{finding.name:<16}{one_line(finding.detail)}"), soft_wrap=True)
    if finding.cure:
        console.print(Text(f"{'':<24}{finding.cure}", style="dim"), soft_wrap=True)
