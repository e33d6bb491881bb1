"""The `legpush` command. Each subcommand imports its modules when it runs, so that `--help` is fast."""

import os
import sys
from collections.abc import Sequence
from functools import singledispatch
from importlib.metadata import version
from typing import Annotated, Final, NoReturn

import tyro

from legpush.errors import ConfigError, exit_code_of, one_line, printable
from legpush.options.conformance import PlanCheckOptions, split_at_dashes
from legpush.options.export import ExportOptions
from legpush.options.learning import CalibrateOptions, EvaluateOptions, TrainOptions
from legpush.options.maps import MapOptions
from legpush.options.numerics import CanaryOptions, KernelOptions, PythonOptions
from legpush.options.policies import Policies
from legpush.options.recordings import BranchOptions, InfoOptions, RecordOptions, RecoverOptions, ReplayOptions
from legpush.options.render import RenderOptions
from legpush.options.run import RunOptions
from legpush.options.scenarios import CopyScenario, ListScenarios, RandomScenario, Scenarios, ShowScenario
from legpush.options.study import MergeStudies, RunStudy, Studies, StudyStatus, StudyTable, VerifyStudy
from legpush.options.view import ViewOptions
from legpush.processes.start_program import Program, start_program, start_python

DESCRIPTION: Final = (
    "A quadruped walks around obstacles to a box and pushes it to a goal pose with a front foot. "
    "`legpush run` runs a whole mission; `legpush --version` prints the version."
)


PROGRAMS: Final[dict[type, Program]] = {
    TrainOptions: "agent_proc.programs.train",
    EvaluateOptions: "agent_proc.programs.evaluate",
    CalibrateOptions: "agent_proc.programs.calibrate",
    MapOptions: "agent_proc.programs.show_map",
    Policies: "agent_proc.programs.policy",
    ExportOptions: "sim_proc.export",
    ViewOptions: "sim_proc.view",
    CanaryOptions: "legpush.canary",
}
"""Programs that run in a process of their own, by the options of their command."""

Command = (
    Annotated[RunOptions, tyro.conf.subcommand("run")]
    | Annotated[TrainOptions, tyro.conf.subcommand("train")]
    | Annotated[EvaluateOptions, tyro.conf.subcommand("evaluate")]
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
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line `argv` and return the exit code; an error is one line on standard error."""
    argv = sys.argv[1:] if argv is None else argv
    if list(argv[:1]) == ["python"] and not {"-h", "--help"} & set(argv[1:2]):
        start_python(argv[1:])
    if list(argv) == ["--version"]:
        sys.stdout.write(f"legpush {version('legpush')}\n")
        return 0
    try:
        return exit_code_of(lambda: _plan_check(argv[1:]) if list(argv[:1]) == ["plan-check"] else _parse_and_run(argv))
    except KeyboardInterrupt:
        return 130


def _parse_and_run(argv: Sequence[str]) -> int:
    """Parse the command line, and run its command."""
    command: (
        RunOptions
        | TrainOptions
        | EvaluateOptions
        | CalibrateOptions
        | PlanCheckOptions
        | Scenarios
        | MapOptions
        | Policies
        | RenderOptions
        | RecordOptions
        | InfoOptions
        | RecoverOptions
        | ReplayOptions
        | BranchOptions
        | ExportOptions
        | ViewOptions
        | PythonOptions
        | KernelOptions
        | CanaryOptions
        | Studies
    ) = tyro.cli(
        Command,
        prog="legpush",
        description=DESCRIPTION,
        args=argv,
        config=(tyro.conf.OmitSubcommandPrefixes, tyro.conf.PositionalRequiredArgs),
    )
    for options, program in PROGRAMS.items():
        if isinstance(command, options):
            start_program(program, argv[1:])
    return execute(command)


def _plan_check(argv: Sequence[str]) -> NoReturn:
    """Check the flags before `--`, then start the program; the planner's command after `--` is not parsed here."""
    flags, _ = split_at_dashes(argv)
    tyro.cli(PlanCheckOptions, prog="legpush plan-check", args=flags)
    start_program("planner_proc.conformance", argv)


@singledispatch
def execute(command: object) -> int:
    """Run a parsed command, and return its exit code."""
    raise TypeError(f"Expected a command of legpush, got {type(command).__name__}")


@execute.register
def _run(command: RunOptions) -> int:
    from rich.console import Console

    from legpush.launch.run import launch_mission

    return launch_mission(command, Console())


@execute.register
def _scenarios(command: Scenarios) -> int:
    return execute(command.action)


@execute.register
def _list_scenarios(_: ListScenarios) -> int:
    from legpush.scenarios.file import load_scenario, scenario_names

    for name in scenario_names():
        sys.stdout.write(f"{name:<18}{load_scenario(name).description}\n")
    return 0


@execute.register
def _show_scenario(command: ShowScenario) -> int:
    from legpush.scenarios.file import dump_scenario, load_scenario
    from legpush.scenarios.short import short_scenario

    text = dump_scenario if command.defaults else short_scenario
    sys.stdout.write(printable(text(load_scenario(command.scenario))))
    return 0


@execute.register
def _copy_scenario(command: CopyScenario) -> int:
    from legpush.scenarios.file import copy_scenario

    for path in copy_scenario(command.name, command.file):
        sys.stdout.write(f"wrote {path}\n")
    return 0


@execute.register
def _random_scenario(command: RandomScenario) -> int:
    start_program("agent_proc.programs.draw_room", command.flags())


@execute.register
def _render(command: RenderOptions) -> int:
    from legpush.launch.film import film_arguments

    if not any(command.run_folder.glob("episode-*.journal")):
        raise ConfigError(f"Expected the folder of a run, with an episode-*.journal in it, got {command.run_folder}")
    argv = film_arguments(command.run_folder, command.camera)
    os.execv(argv[0], argv)  # noqa: S606 - no shell is wanted


@execute.register
def _record(command: RecordOptions) -> int:
    from legpush.launch.record import run_recorder

    return run_recorder(command)


@execute.register
def _info(command: InfoOptions) -> int:
    from legpush.recording.info import lines
    from legpush.recording.mcap_file.reader import read_recording

    sys.stdout.write("".join(f"{one_line(line)}\n" for line in lines(read_recording(command.files))))
    return 0


@execute.register
def _recover(command: RecoverOptions) -> int:
    from legpush.launch.recover import run_recover

    return run_recover(command)


@execute.register
def _replay(command: ReplayOptions) -> int:
    from legpush.launch.replay import replay

    return replay(command)


@execute.register
def _branch(command: BranchOptions) -> int:
    from legpush.launch.branch import branch

    return branch(command)


@execute.register
def _kernel(command: KernelOptions) -> int:
    from legpush.launch.kernel import install_kernel

    return install_kernel(command)


@execute.register
def _studies(command: Studies) -> int:
    try:
        return execute(command.action)
    except ModuleNotFoundError as error:
        raise ConfigError(
            f"Studies need {error.name}, which is not installed; pip install 'legpush[study]' installs it"
        ) from error


@execute.register
def _run_study(command: RunStudy) -> int:
    from rich.console import Console

    from legpush.numerics.entry import enter_profile
    from legpush.study.run import run_study

    enter_profile()
    return run_study(command, Console())


@execute.register
def _study_status(command: StudyStatus) -> int:
    from legpush.study.folder import StudyFolder
    from legpush.study.status import status_lines

    sys.stdout.write("".join(f"{line}\n" for line in status_lines(StudyFolder(command.folder))))
    return 0


@execute.register
def _study_table(command: StudyTable) -> int:
    start_program("agent_proc.programs.study_table", command.flags())


@execute.register
def _verify_study(command: VerifyStudy) -> int:
    from rich.console import Console

    from legpush.numerics.entry import enter_profile
    from legpush.study.verify import verify_study

    enter_profile()
    return verify_study(command, Console())


@execute.register
def _merge_studies(command: MergeStudies) -> int:
    from legpush.study.merge import merge_studies

    n_rows, n_cells = merge_studies(command.folders, command.folder)
    sys.stdout.write(f"{n_rows} of {n_cells} cells; written to {command.folder}\n")
    return 0
