"""What each command does: `execute` of its options. Heavy modules are imported by the command that needs them."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import singledispatch

from legpush.arguments import parse
from legpush.authority.options import AddHosts, BeginAuthority, RenewCertificates, RevokeCertificates, ShowCertificates
from legpush.cli.commands import COMMANDS, choice_of
from legpush.entry.interrupts import hold
from legpush.errors import ConfigError, one_line, printable
from legpush.options.bench import ListFaults, SoakOptions
from legpush.options.checks import require_writable_folder
from legpush.options.export import RenderOptions
from legpush.options.numerics import KernelOptions
from legpush.options.recordings import BranchOptions, InfoOptions, RecordOptions, RecoverOptions, ReplayOptions
from legpush.options.run import RouterOptions, RunOptions
from legpush.options.scenarios import (
    CopyExamples,
    CopyScenario,
    ListExamples,
    ListScenarios,
    ShowScenario,
    changed_scenario,
)
from legpush.options.shell import CompletionOptions, DoctorOptions, HealthOptions
from legpush.options.study import MergeStudies, RunStudy, StudyStatus, VerifyStudy, WorkOptions
from legpush.output.reply import document
from legpush.plugins import why_not_loaded


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
def _list_scenarios(_: ListScenarios) -> int:
    from legpush.scenarios.file import load_scenario, scenario_names

    found = {name: load_scenario(name).description for name in scenario_names()}
    for name, description in found.items():
        sys.stdout.write(f"{name:<18}{description}\n")
    document([{"name": name, "description": description} for name, description in found.items()])
    return 0


@execute.register
def _show_scenario(command: ShowScenario) -> int:
    from legpush.scenarios.file import dump_scenario
    from legpush.scenarios.short import short_scenario

    scenario = changed_scenario(command.scenario, command.changes)
    text = dump_scenario(scenario, whole_robot=True) if command.defaults else short_scenario(scenario)
    sys.stdout.write(printable(text))
    document(scenario)
    return 0


@execute.register
def _copy_scenario(command: CopyScenario) -> int:
    from legpush.scenarios.file import copy_scenario

    files = copy_scenario(command.name, command.file)
    for path in files:
        sys.stdout.write(f"wrote {path}\n")
    document({"files": files})
    return 0


@execute.register
def _list_examples(_: ListExamples) -> int:
    from legpush.cli.example_files import example_files

    files = example_files()
    sys.stdout.write("".join(f"{name}\n" for name in files))
    document([{"name": name, "file": path} for name, path in files.items()])
    return 0


@execute.register
def _copy_examples(command: CopyExamples) -> int:
    from legpush.cli.example_files import copy_examples

    require_writable_folder(command.folder, "DIR")
    files = copy_examples(command.folder)
    sys.stdout.write("".join(f"wrote {path}\n" for path in files))
    document({"files": files})
    return 0


@execute.register
def _render(command: RenderOptions) -> int:
    from legpush.launch.film import film_arguments

    if not any(command.run_folder.glob("episode-*.journal")):
        raise ConfigError(f"Expected the folder of a run, with an episode-*.journal in it, got {command.run_folder}")
    require_writable_folder(command.run_folder, "DIR")
    asked = (
        ("--no-caption", not command.caption),
        ("--json", command.output.json),
        ("--quiet", command.output.quiet),
    )
    flags = [flag for flag, given in asked if given]
    argv = (*film_arguments(command.run_folder, command.camera), *flags)
    hold()
    os.execv(argv[0], argv)  # noqa: S606 - no shell is wanted


@execute.register
def _record(command: RecordOptions) -> int:
    from legpush.launch.record import run_recorder

    return run_recorder(command)


@execute.register
def _info(command: InfoOptions) -> int:
    from legpush.recording.info import facts_of, lines
    from legpush.recording.mcap_file.reader import read_recording

    recording = read_recording(command.files)
    sys.stdout.write("".join(f"{one_line(line)}\n" for line in lines(recording)))
    document(facts_of(recording))
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
def _soak(command: SoakOptions) -> int:
    from rich.console import Console

    from legpush.soak.run import run_soak

    return run_soak(command, Console())


@execute.register
def _list_faults(_: ListFaults) -> int:
    from legpush.soak.table import read_table

    cells = read_table()
    document([{"name": cell.name, "expected": cell.expected, "why": cell.why} for cell in cells])
    for cell in cells:
        sys.stdout.write(f"{cell.name:<32}{cell.expected:<9}{cell.why}".rstrip() + "\n")
    return 0


@execute.register
def _run_study(command: RunStudy) -> int:
    from rich.console import Console

    from legpush.entry.program import enter_profile_quietly

    with _study_libraries():
        from legpush.study.run import run_study

        enter_profile_quietly()
        return run_study(command, Console())


@execute.register
def _work_for_heads(command: WorkOptions) -> int:
    from legpush.entry.program import enter_profile_quietly

    with _study_libraries():
        from legpush.study.engines.worker import work_for_heads

        enter_profile_quietly()
        return work_for_heads(command)


@execute.register
def _study_status(command: StudyStatus) -> int:
    with _study_libraries():
        from legpush.study.folder import StudyFolder
        from legpush.study.status import status_lines, status_of

        status = status_of(StudyFolder(command.folder))
        sys.stdout.write("".join(f"{line}\n" for line in status_lines(status)))
        document(status)
        return 0


@execute.register
def _verify_study(command: VerifyStudy) -> int:
    from rich.console import Console

    from legpush.entry.program import enter_profile_quietly

    with _study_libraries():
        from legpush.study.verify import verify_study

        enter_profile_quietly()
        return verify_study(command, Console())


@execute.register
def _merge_studies(command: MergeStudies) -> int:
    with _study_libraries():
        from legpush.study.merge import merge_studies

        n_rows, n_cells = merge_studies(command.folders, command.folder)
    sys.stdout.write(f"{n_rows} of {n_cells} cells; written to {command.folder}\n")
    document({"folder": command.folder, "n_rows": n_rows, "n_cells": n_cells})
    return 0


@execute.register
def _secure(
    command: BeginAuthority | AddHosts | RenewCertificates | RevokeCertificates | ShowCertificates,
) -> int:
    from legpush.authority.command import run_secure

    return run_secure(command)


@execute.register
def _router(command: RouterOptions) -> int:
    from legpush.launch.router import run_router

    return run_router(command)


@execute.register
def _health(command: HealthOptions) -> int:
    from legpush.doctor.health import tell_health

    return tell_health(command)


@execute.register
def _doctor(command: DoctorOptions) -> int:
    from legpush.doctor.examine import examine

    return examine()


@execute.register
def _completion(command: CompletionOptions) -> int:
    with suppress(SystemExit):  # it prints the script, and ends
        parse(choice_of(COMMANDS), "legpush", ("--tyro-print-completion", command.shell))
    return 0


@contextmanager
def _study_libraries() -> Iterator[None]:
    """Let the work within import the libraries of studies.

    Raises:
        ConfigError: One of them is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        raise ConfigError(f"Expected a study that can run, but {why_not_loaded(error)}") from error
