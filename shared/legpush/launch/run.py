"""`legpush run`: a whole mission, from the options to the report."""

import os
import shlex
import sys
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import datetime
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from rich.console import Console
from rich.text import Text

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.endpoints import in_directory
from legpush.errors import ConfigError
from legpush.launch.display import make_display
from legpush.launch.film import film, film_arguments
from legpush.launch.mission_recorder import MissionRecorder, next_file
from legpush.launch.summary import print_summary, read_report
from legpush.launch.supervisor import (
    BAD_INPUT,
    GAVE_UP,
    INTERRUPTED,
    NO_SUCCESS,
    SUCCESS,
    Limits,
    Supervisor,
    Verdict,
)
from legpush.messages.common import Role
from legpush.options.run import RunOptions, split_command
from legpush.processes.child import Command
from legpush.processes.crew import Crew
from legpush.recording.facts import CONTINUED
from legpush.runs.folder import LOGS, SCENARIO_FILE, default_folder, is_begun, run_folder, run_name
from legpush.runs.live_runs import LiveRun, shown, socket_directory
from legpush.scenarios.file import load_scenario, override
from legpush.scene.scenario import Scenario

ROLES: Final[tuple[Role, ...]] = ("planner", "sim", "agent")
LIBRARIES: Final[dict[Role, tuple[str, ...]]] = {"planner": ("ompl",), "sim": ("mujoco",), "agent": ("matplotlib",)}
"""What each process cannot start without; the rest of its extra comes along."""
RECORDED: Final = ("--recorded",)
"""Has a process keep copies of what it says from its start on, for a recorder that is about to come."""
ONE_THREAD: Final = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
"""Arrays here are small: more threads only get in each other's way."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a run happens."""

    folder: Path
    """What it leaves behind; absolute."""
    sockets: Path
    """A directory of mode 0700 for the sockets of its processes."""

    @property
    def run(self) -> str:
        """Name of the run on the bus."""
        return run_name(self.folder)


def process_arguments(role: Role, options: RunOptions, place: Place) -> tuple[str, ...]:
    """The command line of a process of this package, without what `bus_flags` adds."""
    if role == "planner" and options.planner_command is not None:
        return split_command(options.planner_command)
    # -P: what lies in the working directory is no part of the program.
    arguments = [sys.executable, "-P", "-m", f"{role}_proc"]
    if role == "agent":
        arguments += ["--scenario", str(place.folder / SCENARIO_FILE), "--seed", str(options.seed)]
        arguments += ["--out", str(place.folder), "--policy", options.policy]
        if options.push_map is not None:
            arguments += ["--push-map", str(options.push_map.absolute())]
        if options.record is not None and options.planner_command is not None:
            arguments += ["--witness-planner"]
    return tuple(arguments)


@dataclass(frozen=True, kw_only=True)
class Programs:
    """The command lines that a mission is made of."""

    process: Callable[[Role, RunOptions, Place], tuple[str, ...]] = process_arguments
    film: Callable[[Path], tuple[str, ...]] = film_arguments
    again: Callable[[Path], str] | None = None
    """The command that goes on with an interrupted run in its folder; that of `legpush run` if None."""
    kind: str = "run"
    """The subcommand of `legpush` that runs it."""


def run_mission(
    options: RunOptions, console: Console, programs: Programs | None = None, about: Mapping[str, str] | None = None
) -> int:
    """Run a mission and return the exit code; `LegpushError` for bad input, before anything is started.

    `programs` takes the place of the processes of this package, `about` is metadata for its recording.
    """
    scenario = resolve_scenario(options)
    if programs is None:
        require_libraries()
        programs = Programs()
    folder = options.out or default_folder(scenario, options.seed, datetime.now().astimezone())
    with run_folder(folder, scenario):
        verdict = _run_in(folder, options, programs, console, about or {})
        if verdict.exit_code in (BAD_INPUT, GAVE_UP):
            sys.stderr.write(f"error: {verdict.reason}\n")
        elif verdict.exit_code == INTERRUPTED:
            again = programs.again(folder) if programs.again is not None else _again(options, folder)
            kept = f"; {options.record} stays as it is, the rest gets a file of its own" if options.record else ""
            console.print(Text(f"{verdict.reason}{kept}; to go on: {again}"), soft_wrap=True)
        else:
            if verdict.reason:
                console.print(Text(verdict.reason, style="bold red"), soft_wrap=True)
            print_summary(console, folder, read_report(folder))
    return verdict.exit_code


def resolve_scenario(options: RunOptions) -> Scenario:
    """The scenario with what the options replace in it."""
    changes = {
        "planning.planner": options.planner,
        "planning.steering": options.steering,
        "planning.min_turning_radius_m": options.turning_radius_m,
        "box.mass_kg": options.box_mass_kg,
        "box.friction": options.box_friction,
    }
    scenario = load_scenario(options.scenario)
    return override(scenario, {field: value for field, value in changes.items() if value is not None})


def require_libraries() -> None:
    """`ConfigError` where what the processes need is not installed: better than three of them failing to start."""
    missing = [name for names in LIBRARIES.values() for name in names if find_spec(name) is None]
    if missing:
        raise ConfigError(
            f"Expected the libraries of all three processes, but {', '.join(missing)} is not installed; "
            "pip install '.[all]' in its checkout installs them"
        )


def bus_flags(role: Role, options: RunOptions, place: Place) -> tuple[str, ...]:
    """How a process finds its peers, and how badly they hear each other."""
    endpoints = in_directory(place.sockets, role)
    flags = ["--run", place.run, "--listen", *endpoints.listen]
    if endpoints.connect:
        flags += ["--connect", *endpoints.connect]
    foreign = role == "planner" and options.planner_command is not None
    if options.inject_faults > 0.0 and not foreign:
        flags += ["--inject-faults", str(options.inject_faults), "--fault-seed", str(options.seed)]
    if options.record is not None and not foreign:
        flags += RECORDED
    return tuple(flags)


def flags_again(role: Role, options: RunOptions) -> tuple[str, ...]:
    """What `bus_flags` lack where a process is started again: somebody may be recording by then."""
    foreign = role == "planner" and options.planner_command is not None
    return () if foreign or options.record is not None else RECORDED


def _run_in(
    given: Path, options: RunOptions, programs: Programs, console: Console, about: Mapping[str, str]
) -> Verdict:
    """Run the mission and film it; everything that it started has ended afterwards."""
    with ExitStack() as stack:
        sockets = stack.enter_context(socket_directory())
        place = Place(folder=given.absolute(), sockets=sockets)
        for_recorders = in_directory(sockets, "recorder")
        bus = stack.enter_context(Bus(place.run, "launcher", "main", in_directory(sockets, "launcher")))
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
                argv=programs.process(role, options, place) + bus_flags(role, options, place),
                log=place.folder / LOGS / f"{role}.log",
                environment=environment,
                flags_again=flags_again(role, options),
            )
            for role in ROLES
        ]
        supervisor = Supervisor(
            crew,
            display,
            is_alive=lambda role: any(peer.role == role for peer in bus.roster.live()),
            hear=statuses.drain,
            limits=Limits(mission_s=options.deadline_s),
            on_bystander=lambda process: recorder.ended(process) if recorder is not None else None,
        )
        with shown(LiveRun.now(place.run, programs.kind, place.folder, for_recorders.connect), sockets):
            verdict = supervisor.run(commands)
        if recorder is not None:
            recorder.report(place.folder)
        if verdict.exit_code in (SUCCESS, NO_SUCCESS) and options.video:
            command = Command(
                role="video",
                argv=programs.film(place.folder),
                log=place.folder / LOGS / "video.log",
                environment=environment,
            )
            return film(command, crew, display) or verdict
        return verdict


def child_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """What the processes get: what the launcher has, one thread per library, and output as it comes."""
    return {**environment, **ONE_THREAD, "PYTHONUNBUFFERED": "1"}


def _again(options: RunOptions, folder: Path) -> str:
    """The command that goes on with an interrupted run."""
    words = ["legpush", "run", "--scenario", str(folder / SCENARIO_FILE), "--seed", str(options.seed)]
    words += ["--out", str(folder), "--policy", options.policy]
    if options.planner_command is not None:
        words += ["--planner-command", options.planner_command]
    if options.push_map is not None:
        words += ["--push-map", str(options.push_map)]
    if not options.video:
        words += ["--no-video"]
    if options.inject_faults > 0.0:
        words += ["--inject-faults", str(options.inject_faults)]
    if options.deadline_s is not None:
        words += ["--deadline", str(options.deadline_s)]
    if options.record is not None:
        words += ["--record", str(next_file(options.record))]
    return shlex.join(words)
