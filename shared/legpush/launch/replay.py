"""`legpush replay`: verifies a recording, lets it take the part of a process, or publishes it again."""

import logging
import shlex
import sys
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Literal

from rich.console import Console

from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, local
from legpush.bus.secure.host_folder import credentials_of
from legpush.errors import INTERRUPTED, ConfigError, OtherVersionError, StopRequestedError, one_line, printable
from legpush.launch.display import make_display
from legpush.launch.process_commands import Place, Programs, process_arguments, recorded_policy_flags
from legpush.launch.run import launch_mission
from legpush.lockstep.bus_world import BusWorld
from legpush.lockstep.client import SimLink
from legpush.messages.common import Role
from legpush.options.recordings import ReplayOptions
from legpush.options.run import RunOptions
from legpush.output.reply import document
from legpush.plans.client import PlanLink
from legpush.policy_names import require_repeated
from legpush.processes.child_numerics import child_numerics
from legpush.processes.pool import SimPool
from legpush.processes.start_program import program_command
from legpush.recording.episodes import difference, same
from legpush.recording.facts import STILL, recorded_with, unpack_mission
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.plans import read_plans
from legpush.recording.publish import from_start, publish
from legpush.recording.verify import check
from legpush.runs.temporary import temporary_folder
from legpush.service import stop_on_signals


def replay(options: ReplayOptions) -> int:
    """Run the command, and return its exit code."""
    logging.basicConfig(level=logging.ERROR)
    if options.verify:
        return verify_files(options.files, Console())
    if options.as_role == "agent":
        return play_agent(options.files, Console())
    if options.as_role is not None:
        return play(options, options.as_role, Console())
    return publish_again(options)


def publish_again(options: ReplayOptions) -> int:
    """Hand everything to recorders and views, and return 0 at the end, or 130 if interrupted before."""
    recording = read_recording(options.files)
    from_start(recording, options.start_s)
    stop = stop_on_signals()
    credentials = credentials_of(options.secure, "launcher")
    listen = options.listen or local("agent", credentials).listen
    with Bus(options.run, "launcher", "replay", Endpoints(listen=listen, credentials=credentials)) as bus:
        bus.announce()
        words = ["legpush", "record", "FILE", "--run", options.run, "--connect", *listen]
        words += [] if options.secure is None else ["--secure", str(options.secure)]
        sys.stdout.write(f"publishing as run {options.run}; `{shlex.join(words)}`\n")
        sys.stdout.flush()
        turn = n = 0
        while not stop.is_set() and (options.loop or turn == 0):
            n += publish(bus, recording, options.rate, options.start_s, stop, turn)
            turn += 1
    sys.stdout.write(f"published {n} messages\n")
    document({"run": options.run, "n_messages": n})
    return INTERRUPTED if stop.is_set() and not options.loop else 0


def play(options: ReplayOptions, role: Literal["sim", "planner"], console: Console) -> int:
    """Run the recorded mission with the recording in the place of one process, and return its exit code.

    Raises:
        PolicyError: The recorded policy runs code and was not repeated.
        ConfigError: `--policy` is another policy than that of the recording.
    """
    with temporary_folder("replay-") as folder:
        mission = unpack_mission(read_recording(options.files), folder)
        require_repeated(mission.facts.policy, options.policy)
        if options.policy not in (None, mission.facts.policy):
            raise ConfigError(f"Expected the recorded policy {mission.facts.policy} for --policy, got {options.policy}")
        flags = recorded_policy_flags(mission.facts, None, options.policy)
        files = tuple(str(path.absolute()) for path in options.files)

        def process(of: Role, run: RunOptions, place: Place) -> tuple[str, ...]:
            if of == role:
                return tuple(program_command("legpush.recording.play", (role, *files)))
            return process_arguments(of, run, place)

        run = RunOptions(
            scenario=str(mission.scenario),
            seed=mission.facts.seed,
            policy=mission.facts.policy,
            trust_policy_file=options.trust_policy_file,
            push_map=mission.push_map,
            out=options.out,
            video=False,
        )
        return launch_mission(run, console, Programs(process=process, agent_flags=flags, kind="replay"))


def play_agent(files: tuple[Path, ...], console: Console) -> int:
    """Send the recorded requests to a live planner and simulator, and compare the answers; return 0 if identical.

    Raises:
        OtherVersionError: Plans are different, and the recording is of another version.
    """
    recording = read_recording(files)
    plans, stop = read_plans(recording), stop_on_signals()
    with ExitStack() as stack:
        logs = stack.enter_context(temporary_folder("replay-"))
        planners = stack.enter_context(SimPool(1, logs, stop, kind="replay", role="planner"))
        bus = stack.enter_context(Bus(planners.run, "agent", "planning", planners.endpoints))
        link = PlanLink(bus, stop=stop)
        bus.announce()
        for number, record in enumerate(plans):
            for revision, expected in sorted(record.plans.items()):
                got = link.revision(revision, record.query) if revision else link.plan(record.query)
                if expected.status != "cancelled" and not same(expected, got):
                    path, one, other = difference(expected, got)
                    recorded = recorded_with(recording)
                    if version := recorded.other_version():
                        raise OtherVersionError(f"{version}; {STILL}")
                    numerics = recorded.other_numerics(child_numerics())
                    what = f"{numerics}; first difference" if numerics else "first divergence"
                    where = f"plan {number}, field {path}"
                    sys.stdout.write(printable(f"{what} at {where}: expected {one}, got {other}\n"))
                    document({"identical": False, "plan": number, "field": path, "expected": one, "got": other})
                    return 1
            link.cancel()
    sys.stdout.write(f"identical: {len(plans)} plans\n")
    return verify_files(files, console)


def verify_files(files: tuple[Path, ...], console: Console) -> int:
    """Compare the recording with a simulator process of its own; return 0 if identical and whole, 1 if not.

    A recording with other numerics is not called diverged: the words say what was recorded with, and what is here. One
    of another version cannot be verified unless it is identical: then the exit code is 2.

    Raises:
        RecordingError: No episode was recorded from its reset on.
        StopRequestedError: Interrupted before the end.
    """
    recording = read_recording(files)
    stop = stop_on_signals()
    began = perf_counter()
    with ExitStack() as stack:
        logs = stack.enter_context(temporary_folder("verify-"))
        pool = stack.enter_context(SimPool(1, logs, stop, kind="replay"))
        bus = stack.enter_context(Bus(pool.run, "agent", "main", pool.endpoints))
        display = stack.enter_context(make_display(console))
        world = BusWorld(SimLink(bus, pool.names[0], stop=stop))
        bus.announce()
        try:
            checked = check(
                recording, world.step, child_numerics, lambda text: display.progress("verifying", None, text, "")
            )
        except StopRequestedError as error:
            raise StopRequestedError("interrupted: not verified") from error
    sys.stdout.write(printable(checked.words(perf_counter() - began)))
    document({"identical": checked.is_sound, "complete": recording.is_complete, **asdict(checked)})
    if checked.is_sound and not recording.is_complete:
        notes = recording.completeness.get("notes") or "its recorder did not finish"
        sys.stdout.write(f"the recording is not complete: {one_line('; '.join(notes.splitlines()))}\n")
    if checked.other_version:
        return OtherVersionError.exit_code
    return 0 if checked.is_sound else 1
