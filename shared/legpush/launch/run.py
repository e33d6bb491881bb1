"""`legpush run`: runs a whole mission, from the options to the report."""

import os
import shlex
import sys
from collections.abc import Mapping
from contextlib import ExitStack
from datetime import datetime
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from rich.console import Console
from rich.text import Text

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.endpoints import LISTENING, free_ports
from legpush.errors import DISK_FULL, INTERRUPTED, ConfigError, LegpushError, is_disk_full, printable
from legpush.files import next_file, require_space, write_whole
from legpush.history.mending import mend
from legpush.launch.display import make_display
from legpush.launch.film import film
from legpush.launch.mission_recorder import MissionRecorder
from legpush.launch.preflight import check_mission
from legpush.launch.process_commands import Place, Programs, bus_flags, flags_again
from legpush.launch.summary import print_summary
from legpush.launch.supervisor import BAD_INPUT, GAVE_UP, NO_SUCCESS, SUCCESS, Limits, Supervisor, Verdict
from legpush.messages.common import ROLES, Role
from legpush.options.run import RunOptions
from legpush.output.reply import document
from legpush.policy_names import TRUST_FILE
from legpush.processes.child import Command
from legpush.processes.crew import Crew
from legpush.processes.environment import child_environment
from legpush.recording.facts import CONTINUED
from legpush.runs.folder import (
    COMMAND_FILE,
    LOGS,
    REPORT_FILE,
    SCENARIO_FILE,
    VIDEO_FILE,
    default_folder,
    is_begun,
    journals,
    run_folder,
)
from legpush.runs.live_runs import LiveRun, clear_killed_runs, shown, socket_directory
from legpush.runs.reasons import ENDED_BY_ERROR
from legpush.runs.report import add_note, read_report
from legpush.scenarios.file import dump_scenario
from legpush.scene.scenario import Scenario

LIBRARIES: Final[dict[Role, tuple[str, ...]]] = {"planner": ("ompl",), "sim": ("mujoco",), "agent": ("matplotlib",)}
"""A library that each process cannot start without; the rest of its extra is installed with it."""


def launch_mission(
    options: RunOptions, console: Console, programs: Programs | None = None, about: Mapping[str, str] | None = None
) -> int:
    """Run a mission, and return the exit code.

    `programs` takes the place of the processes of this package, and `about` is metadata for the recording.

    Raises:
        LegpushError: The input cannot be used. Nothing was started.
    """
    scenario = options.resolved_scenario()
    if programs is None:
        require_libraries()
        programs = Programs()
    folder = options.out or default_folder(scenario, options.seed, datetime.now().astimezone())
    check_mission(options, scenario, folder, programs)
    if options.dry_run:
        console.print(Text(printable(dump_scenario(scenario))), soft_wrap=True)
        document({"scenario": scenario, "seed": options.seed, "policy": options.policy, "folder": folder})
        return SUCCESS
    again = programs.again(folder) if programs.again is not None else _again(options, folder)
    try:
        verdict = _run_and_tell(folder, scenario, options, programs, console, about or {}, again)
    except (LegpushError, OSError) as error:
        if not is_disk_full(error):
            raise
        verdict = Verdict(DISK_FULL, str(error))
    if verdict.exit_code == DISK_FULL:
        sys.stderr.write(f"error: {printable(verdict.reason)}\n")
        console.print(Text(f"after space is made, to go on: {again}"), soft_wrap=True)
    return verdict.exit_code


def _run_and_tell(
    folder: Path,
    scenario: Scenario,
    options: RunOptions,
    programs: Programs,
    console: Console,
    about: Mapping[str, str],
    again: str,
) -> Verdict:
    """Run the mission in its folder, and tell the user how it ended, except on a full disk."""
    for line in clear_killed_runs():
        console.print(Text(line), soft_wrap=True)
    with run_folder(folder, scenario, private=options.out is None):
        if (report := finished_report(folder, options)) is not None:
            console.print(Text(f"finished already; the report in {folder} is kept"), soft_wrap=True)
            _summarize(console, folder, report)
            return Verdict(SUCCESS if report["success"] else NO_SUCCESS)
        for journal in journals(folder):
            if done := mend(journal):
                console.print(Text(done), soft_wrap=True)
        write_whole(folder / LOGS / COMMAND_FILE, f"{again}\n".encode(), private=True)
        verdict = _run_in(folder, options, programs, console, about)
        if verdict.exit_code in (NO_SUCCESS, GAVE_UP) and not (folder / REPORT_FILE).exists():
            require_space(folder)  # on a full disk a process cannot even say so in its log
        if verdict.exit_code in (BAD_INPUT, GAVE_UP):
            sys.stderr.write(f"error: {printable(verdict.reason)}\n")
            if verdict.exit_code == BAD_INPUT and (folder / REPORT_FILE).exists():
                _summarize(console, folder, read_report(folder))
        elif verdict.exit_code == INTERRUPTED:
            kept = f"; {options.record} stays as it is, the rest gets a file of its own" if options.record else ""
            console.print(Text(f"{verdict.reason}{kept}; to go on: {again}"), soft_wrap=True)
        elif verdict.exit_code != DISK_FULL:
            if verdict.reason:
                console.print(Text(printable(verdict.reason), style="bold red"), soft_wrap=True)
            _summarize(console, folder, read_report(folder))
            if options.video and (interrupted := _film(folder, programs, console)) is not None:
                words = f"{interrupted.reason}; to make the film: legpush render {shlex.quote(str(folder))}"
                console.print(Text(words), soft_wrap=True)
                return interrupted
        return verdict


def _summarize(console: Console, folder: Path, report: dict[str, Any]) -> None:
    """Tell people and programs what came out."""
    print_summary(console, folder, report)
    document({"folder": folder, **report})


def finished_report(folder: Path, options: RunOptions) -> dict[str, Any] | None:
    """Return the report of a mission that is over, if the options would run it again; None to run or continue.

    A mission that ended with an error is tried again. Another seed or policy is left to the agent, which refuses it.
    """
    command = folder / LOGS / COMMAND_FILE
    if not (folder / REPORT_FILE).exists() or not command.exists() or not is_begun(folder):
        return None
    report, words = read_report(folder), shlex.split(command.read_text(encoding="utf-8"))
    policies = [after for word, after in pairwise(words) if word == "--policy"]
    over = report.get("reason") not in ENDED_BY_ERROR
    return report if over and report.get("seed") == options.seed and options.policy in policies else None


def require_libraries() -> None:
    """Check that the libraries of all three processes are installed, before any of them fails to start.

    Raises:
        ConfigError: A library is missing.
    """
    missing = [name for names in LIBRARIES.values() for name in names if find_spec(name) is None]
    if missing:
        raise ConfigError(
            f"Expected the libraries of all three processes, but {', '.join(missing)} is not installed; "
            "pip install legpush installs them"
        )


def _run_in(
    given: Path, options: RunOptions, programs: Programs, console: Console, about: Mapping[str, str]
) -> Verdict:
    """Run the mission; every process has ended when this returns."""
    with ExitStack() as stack:
        sockets = stack.enter_context(socket_directory())
        ports = {} if options.secure is None else free_ports(LISTENING)
        place = Place(folder=given.absolute(), sockets=sockets, secure=options.secure, ports=ports)
        for_recorders = place.endpoints("recorder")
        bus = stack.enter_context(Bus(place.run, "launcher", "main", place.endpoints("launcher")))
        statuses = bus.subscribe(channels.statuses(bus.run))
        display = stack.enter_context(make_display(console))
        crew = stack.enter_context(Crew())

        environment = child_environment(os.environ)
        recorder = None
        if options.record is not None:
            log = place.folder / LOGS / "recorder.log"
            recorder = MissionRecorder(options.record, place.run, for_recorders, display)
            recorder.start(crew, log, environment, {**about, **({CONTINUED: "yes"} if is_begun(place.folder) else {})})
        commands = [
            Command(
                role=role,
                argv=programs.process(role, options, place)
                + (programs.agent_flags if role == "agent" else ())
                + bus_flags(role, options, place),
                log=place.folder / LOGS / f"{role}.log",
                environment=environment,
                flags_again=flags_again(role, options),
            )
            for role in ROLES
        ]
        supervisor = Supervisor(
            crew,
            display,
            is_alive=lambda role: any(peer.role == role for peer in bus.liveliness.live()),
            hear=statuses.drain,
            limits=Limits(mission_s=options.deadline_s),
            has_result=(place.folder / REPORT_FILE).exists,
            on_bystander=lambda process: recorder.note_end(process) if recorder is not None else None,
        )
        with shown(LiveRun.now(place.run, programs.kind, place.folder, for_recorders.connect), sockets):
            verdict = supervisor.run(commands)
        if recorder is not None:
            recorder.complete_report(place.folder)
        return verdict


def _film(folder: Path, programs: Programs, console: Console) -> Verdict | None:
    """Film a mission whose report is on the screen; return the verdict of an interrupt, otherwise None."""
    notes: list[str] = []

    def note(text: str) -> None:
        notes.append(text)
        add_note(folder, text)

    command = Command(
        role="video",
        argv=programs.film(folder.absolute()),
        log=folder.absolute() / LOGS / "video.log",
        environment=child_environment(os.environ),
    )
    with ExitStack() as stack:
        display = stack.enter_context(make_display(console))
        interrupted = film(command, stack.enter_context(Crew()), display, note)
    for text in notes:
        console.print(Text(printable(text)), soft_wrap=True)
    if interrupted is None and not notes:
        console.print(Text(f"  {VIDEO_FILE}: the mission, filmed"), soft_wrap=True)
    document({"folder": folder, **read_report(folder)})
    return interrupted


def _again(options: RunOptions, folder: Path) -> str:
    """Return the command that continues an interrupted run."""
    words = ["legpush", "run", str(folder / SCENARIO_FILE), "--seed", str(options.seed)]
    words += ["--out", str(folder), "--policy", options.policy]
    if options.trust_policy_file:
        words += [TRUST_FILE]
    if options.planner_command is not None:
        words += ["--planner-command", options.planner_command]
    if options.push_map is not None:
        words += ["--push-map", str(options.push_map)]
    if options.secure is not None:
        words += ["--secure", str(options.secure)]
    if not options.picture:
        words += ["--no-picture"]
    if not options.video:
        words += ["--no-video"]
    if options.inject_faults > 0.0:
        words += ["--inject-faults", str(options.inject_faults)]
    if options.deadline_s is not None:
        words += ["--deadline", str(options.deadline_s)]
    if options.record is not None:
        words += ["--record", str(next_file(options.record))]
    return shlex.join(words)
