"""`legpush branch`: a run that continues a recorded mission."""

import shlex
import sys
from pathlib import Path

from rich.console import Console

from legpush.files import next_file, sha256_of
from legpush.launch.process_commands import Programs, recorded_policy_flags
from legpush.launch.run import launch_mission
from legpush.options.recordings import BranchOptions
from legpush.options.run import RunOptions
from legpush.policy_names import TRUST_FILE, require_repeated
from legpush.recording.branch import RecordedPast, parse_point
from legpush.recording.facts import read_facts, unpack_mission
from legpush.recording.mcap_file.reader import read_recording
from legpush.runs.temporary import temporary_folder


def branch(options: BranchOptions) -> int:
    """Run the branch, and return the exit code of the mission."""
    at = parse_point(options.at)
    recording = read_recording(options.files)
    RecordedPast(recording, at)
    flags = ["--branch-of", *(str(path.absolute()) for path in recording.files), "--branch-at", str(at)]
    for name, value in {"planner": options.planner, **options.changed_box()}.items():
        if value is not None:
            flags += [f"--branch-{name.replace('_', '-')}", str(value)]

    console, facts = Console(), read_facts(recording)
    if not is_changed(options, facts.policy):
        console.print(f"nothing is changed at {at}: this repeats the recording", soft_wrap=True)
    past = options.policy if options.past_policy is None else options.past_policy
    require_repeated(facts.policy, past, "--policy" if options.policy is None else "--past-policy")
    repeated = past if past == facts.policy else None
    flags += recorded_policy_flags(facts, options.policy, repeated)

    about = {
        "parent_file": " ".join(path.name for path in recording.files),
        "parent_sha256": sha256_of(recording.files),
        "parent_episode": str(at.episode),
        "parent_step": str(at.step),
        "branch": shlex.join(sys.argv[1:]),
    }
    with temporary_folder("branch-") as folder:
        mission = unpack_mission(recording, folder)
        run = RunOptions(
            scenario=str(mission.scenario),
            seed=mission.facts.seed,
            policy=mission.facts.policy if options.policy is None else options.policy,
            trust_policy_file=options.trust_policy_file,
            push_map=mission.push_map,
            planner_command=options.planner_command,
            out=options.out,
            record=options.record or default_file(options),
            video=options.video,
        )
        programs = Programs(agent_flags=tuple(flags), again=lambda folder: again(options, folder), kind="branch")
        return launch_mission(run, console, programs, about)


def is_changed(options: BranchOptions, recorded_policy: str) -> bool:
    """Return whether the options change anything of the mission."""
    return options.policy not in (None, recorded_policy) or any(
        (options.planner, options.planner_command, options.changes)
    )


def default_file(options: BranchOptions) -> Path:
    """Return a free file name beside the old recording."""
    first, at = options.files[0], parse_point(options.at)
    file = first.with_name(f"{first.stem}-branch-{at.episode}-{at.step}{first.suffix}")
    return next_file(file) if file.exists() else file


def again(options: BranchOptions, folder: Path) -> str:
    """Return the command that continues an interrupted branch; it records into a new file."""
    words = ["legpush", "branch", *map(str, options.files), "--at", options.at, "--out", str(folder)]
    for name in ("policy", "past_policy", "planner", "planner_command"):
        if (value := getattr(options, name)) is not None:
            words += [f"--{name.replace('_', '-')}", str(value)]
    words += [word for change in options.changes for word in ("--set", change)]
    words += [TRUST_FILE] if options.trust_policy_file else []
    return shlex.join([*words, "--video"] if options.video else words)
