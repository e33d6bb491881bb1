"""The command line of `legpush`. Each subcommand imports its modules when it runs, so that `--help` is fast."""

import sys
from collections.abc import Sequence
from importlib.metadata import version
from typing import Final

from legpush.arguments import USUAL_OUTPUT, parse
from legpush.cli.commands import COMMANDS, PROGRAMS, Group, Line, choice_of, find_command
from legpush.cli.execute import execute
from legpush.errors import exit_code_of
from legpush.options.conformance import PlanCheckOptions, split_at_dashes
from legpush.options.numerics import PythonOptions
from legpush.options.recordings import BranchOptions, ReplayOptions
from legpush.options.run import RunOptions
from legpush.output.guarded_streams import Output, with_guarded_output
from legpush.output.reply import replying
from legpush.processes.start_program import start_program, start_python

DESCRIPTION: Final = (
    "A quadruped walks around obstacles to a box and pushes it to a goal pose with a front foot. "
    "`legpush run` runs a whole mission, `legpush COMMAND --help` explains a command, `legpush --version` prints the "
    "version."
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line `argv` and return the exit code; an error is one line on standard error."""
    return with_guarded_output(lambda output: _run_line(sys.argv[1:] if argv is None else argv, output))


def _run_line(argv: Sequence[str], output: Output) -> int:
    """Run a command line and return the exit code."""
    if list(argv) == ["--version"]:
        sys.stdout.write(f"legpush {version('legpush')}\n")
        return 0
    return exit_code_of(lambda: _find_and_run(argv, output))


def _find_and_run(argv: Sequence[str], output: Output) -> int:
    """Parse the command line with the options of its command alone, and run the command.

    Raises:
        ConfigError: There is no such command, or its options cannot be used.
    """
    line = find_command(argv)
    if line is None or isinstance(line, Group):
        prog, table = ("legpush", COMMANDS) if line is None else (f"legpush {argv[0]}", line.commands)
        about = DESCRIPTION if line is None else line.what
        parse(choice_of(table), prog, argv[len(prog.split()) - 1 :] or ["--help"], description=about)
    assert isinstance(line, Line)  # noqa: S101 - help has ended the process
    prog = f"legpush {line.command}"
    if line.options is PythonOptions and line.arguments[:1] not in (("-h",), ("--help",)):
        start_python(line.arguments)
    flags = split_at_dashes(line.arguments)[0] if line.options is PlanCheckOptions else line.arguments
    command = parse(line.options, prog, flags)
    if line.options in PROGRAMS:
        program, *words = PROGRAMS[line.options]
        start_program(program, (*words, *line.arguments))
    output.decides = not _is_mission(command)
    with replying(getattr(command, "output", USUAL_OUTPUT)):
        return execute(command)


def _is_mission(command: object) -> bool:
    """Return whether the exit code of a command says how a mission ended, whatever becomes of its output."""
    return isinstance(command, RunOptions | BranchOptions) or (
        isinstance(command, ReplayOptions) and command.as_role is not None
    )
