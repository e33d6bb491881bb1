"""What each command does: `execute` of its options. Heavy modules are imported by the command that needs them."""

import os
import sys
from functools import singledispatch

from legpush.entry.interrupts import hold
from legpush.errors import ConfigError, one_line, printable
from legpush.options.bench import Bench, ListFaults, SoakOptions
from legpush.options.checks import require_writable_folder
from legpush.options.numerics import KernelOptions
from legpush.options.recordings import BranchOptions, InfoOptions, RecordOptions, RecoverOptions, ReplayOptions
from legpush.options.render import RenderOptions
from legpush.options.run import RunOptions
from legpush.options.scenarios import CopyScenario, ListScenarios, RandomScenario, Scenarios, ShowScenario
from legpush.options.study import MergeStudies, RunStudy, Studies, StudyStatus, StudyTable, VerifyStudy
from legpush.plugins import why_not_loaded
from legpush.processes.start_program import start_program


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

    scenario = load_scenario(command.scenario)
    text = dump_scenario(scenario, whole_robot=True) if command.defaults else short_scenario(scenario)
    sys.stdout.write(printable(text))
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
    require_writable_folder(command.run_folder, "RUN_FOLDER")
    argv = film_arguments(command.run_folder, command.camera)
    hold()
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
def _bench(command: Bench) -> int:
    return execute(command.action)


@execute.register
def _soak(command: SoakOptions) -> int:
    from rich.console import Console

    from legpush.soak.run import run_soak

    return run_soak(command, Console())


@execute.register
def _list_faults(_: ListFaults) -> int:
    from legpush.soak.table import read_table

    for cell in read_table():
        sys.stdout.write(f"{cell.name:<32}{cell.expected:<9}{cell.why}".rstrip() + "\n")
    return 0


@execute.register
def _studies(command: Studies) -> int:
    try:
        return execute(command.action)
    except ModuleNotFoundError as error:
        raise ConfigError(f"Expected a study that can run, but {why_not_loaded(error)}") from error


@execute.register
def _run_study(command: RunStudy) -> int:
    from rich.console import Console

    from legpush.entry.program import enter_profile_quietly
    from legpush.study.run import run_study

    enter_profile_quietly()
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

    from legpush.entry.program import enter_profile_quietly
    from legpush.study.verify import verify_study

    enter_profile_quietly()
    return verify_study(command, Console())


@execute.register
def _merge_studies(command: MergeStudies) -> int:
    from legpush.study.merge import merge_studies

    n_rows, n_cells = merge_studies(command.folders, command.folder)
    sys.stdout.write(f"{n_rows} of {n_cells} cells; written to {command.folder}\n")
    return 0
