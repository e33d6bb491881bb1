"""The command line of `legpush`. Each subcommand imports its modules when it runs, so that `--help` is fast."""

import sys
from collections.abc import Sequence
from importlib.metadata import version
from typing import Annotated, Final, NoReturn

import tyro

from legpush.cli.execute import execute
from legpush.errors import exit_code_of
from legpush.options.bench import Bench
from legpush.options.conformance import PlanCheckOptions, split_at_dashes
from legpush.options.export import ExportOptions
from legpush.options.learning import CalibrateOptions, EvaluateOptions, TrainOptions
from legpush.options.learning_tools import CompareOptions, TuneOptions
from legpush.options.maps import MapOptions
from legpush.options.numerics import CanaryOptions, KernelOptions, PythonOptions
from legpush.options.policies import Policies
from legpush.options.recordings import BranchOptions, InfoOptions, RecordOptions, RecoverOptions, ReplayOptions
from legpush.options.render import RenderOptions
from legpush.options.run import RunOptions
from legpush.options.scenarios import Scenarios
from legpush.options.study import Studies
from legpush.options.view import ViewOptions
from legpush.output.guarded_streams import Output, with_guarded_output
from legpush.processes.start_program import Program, start_program, start_python

DESCRIPTION: Final = (
    "A quadruped walks around obstacles to a box and pushes it to a goal pose with a front foot. "
    "`legpush run` runs a whole mission; `legpush --version` prints the version."
)


PROGRAMS: Final[dict[type, Program]] = {
    TrainOptions: "agent_proc.programs.train",
    EvaluateOptions: "agent_proc.programs.evaluate",
    CompareOptions: "agent_proc.programs.compare",
    TuneOptions: "agent_proc.programs.tune",
    CalibrateOptions: "agent_proc.programs.calibrate",
    MapOptions: "agent_proc.programs.show_map",
    Policies: "agent_proc.programs.policy",
    ExportOptions: "sim_proc.export.program",
    ViewOptions: "sim_proc.view.program",
    CanaryOptions: "legpush.canary",
}
"""Programs that run in a process of their own, by the options of their command."""

Command = (
    Annotated[RunOptions, tyro.conf.subcommand("run")]
    | Annotated[TrainOptions, tyro.conf.subcommand("train")]
    | Annotated[EvaluateOptions, tyro.conf.subcommand("evaluate")]
    | Annotated[CompareOptions, tyro.conf.subcommand("compare")]
    | Annotated[TuneOptions, tyro.conf.subcommand("tune")]
    | Annotated[CalibrateOptions, tyro.conf.subcommand("calibrate")]
    | Annotated[PlanCheckOptions, tyro.conf.subcommand("plan-check")]
    | Annotated[Scenarios, tyro.conf.subcommand("scenarios")]
    | Annotated[MapOptions, tyro.conf.subcommand("map")]
    | Annotated[Policies, tyro.conf.subcommand("policy")]
    | Annotated[RenderOptions, tyro.conf.subcommand("render")]
    | Annotated[RecordOptions, tyro.conf.subcommand("record")]
    | Annotated[InfoOptions, tyro.conf.subcommand("info")]
    | Annotated[RecoverOptions, tyro.conf.subcommand("recover")]
    | Annotated[ReplayOptions, tyro.conf.subcommand("replay")]
    | Annotated[BranchOptions, tyro.conf.subcommand("branch")]
    | Annotated[ExportOptions, tyro.conf.subcommand("export")]
    | Annotated[ViewOptions, tyro.conf.subcommand("view")]
    | Annotated[PythonOptions, tyro.conf.subcommand("python")]
    | Annotated[KernelOptions, tyro.conf.subcommand("kernel")]
    | Annotated[CanaryOptions, tyro.conf.subcommand("canary")]
    | Annotated[Studies, tyro.conf.subcommand("study")]
    | Annotated[Bench, tyro.conf.subcommand("bench")]
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line `argv` and return the exit code; an error is one line on standard error."""
    return with_guarded_output(lambda output: _run_line(sys.argv[1:] if argv is None else argv, output))


def _run_line(argv: Sequence[str], output: Output) -> int:
    """Run a command line and return the exit code."""
    if list(argv[:1]) == ["python"] and not {"-h", "--help"} & set(argv[1:2]):
        start_python(argv[1:])
    if list(argv) == ["--version"]:
        sys.stdout.write(f"legpush {version('legpush')}\n")
        return 0
    return exit_code_of(
        lambda: _plan_check(argv[1:]) if list(argv[:1]) == ["plan-check"] else _parse_and_run(argv, output)
    )


def _parse_and_run(argv: Sequence[str], output: Output) -> int:
    """Parse the command line, and run its command."""
    command: object = tyro.cli(
        Command,
        prog="legpush",
        description=DESCRIPTION,
        args=argv,
        config=(tyro.conf.OmitSubcommandPrefixes, tyro.conf.PositionalRequiredArgs),
    )
    for options, program in PROGRAMS.items():
        if isinstance(command, options):
            start_program(program, argv[1:])
    output.decides = not _is_mission(command)
    return execute(command)


def _is_mission(command: object) -> bool:
    """Return whether the exit code of a command says how a mission ended, whatever becomes of its output."""
    return isinstance(command, RunOptions | BranchOptions) or (
        isinstance(command, ReplayOptions) and command.as_role is not None
    )


def _plan_check(argv: Sequence[str]) -> NoReturn:
    """Check the flags before `--`, then start the program; the planner's command after `--` is not parsed here."""
    flags, _ = split_at_dashes(argv)
    tyro.cli(PlanCheckOptions, prog="legpush plan-check", args=flags)
    start_program("planner_proc.conformance.program", argv)
