"""`legpush recover`: makes a whole recording of a damaged one, or a journal that goes on of a damaged one."""

import shlex
import sys
from itertools import pairwise
from pathlib import Path
from typing import Final

from legpush.errors import ConfigError, one_line, printable
from legpush.history.entries import Opened
from legpush.history.mending import step_back
from legpush.options.checks import require_new_file
from legpush.options.recordings import RecoverOptions
from legpush.output.reply import document
from legpush.policy_names import TRUST_FILE, runs_code
from legpush.recording.recover import recover
from legpush.runs.folder import COMMAND_FILE, LOGS, journals, own_folder

CODE_FLAGS: Final = ("--planner-command", TRUST_FILE, "--past-policy")
"""Flags with which a command runs code of its user."""


def run_recover(options: RecoverOptions) -> int:
    """Run the command, and return its exit code.

    Raises:
        RecordingError: The recording is whole, nothing in it can be read, or the new file cannot be written.
        JournalError: The journal is whole, or nothing in it can be used.
        ConfigError: The folder is not that of a run, or a launcher is running in it.
    """
    if options.file.is_dir():
        return _recover_run(options.file)
    out = options.out or options.file.with_name(f"{options.file.stem}-recovered{options.file.suffix}")
    require_new_file(out, "--out")
    recording = recover(options.file, out)
    notes = recording.completeness["notes"].splitlines()
    said = "".join(f"    {note}\n" for note in notes)
    sys.stdout.write(printable(f"wrote {out}: {len(recording.messages)} messages\n{said}"))
    document({"file": out, "n_messages": len(recording.messages), "notes": notes})
    return 0


def _recover_run(folder: Path) -> int:
    """Cut off the journals of a run at their first damage, and say how the mission goes on."""
    found = journals(folder)
    if not found:
        raise ConfigError(f"Expected a recording, or the folder of a run with a journal in it, got {folder}")
    mended = []
    with own_folder(folder):
        for journal in found:
            opened, done = step_back(journal)
            command = _command(folder, opened)
            sys.stdout.write(printable(f"{done}\nto go on: {command}\n"))
            mended.append({"journal": journal, "done": done, "to_go_on": command})
    document({"journals": mended})
    return 0


def _command(folder: Path, opened: Opened) -> str:
    """Return the command with which the mission goes on.

    The folder may come from somebody else. Its command is shown only if it is one that the launcher writes, and if all
    that it can run is a mission with a policy and a planner of this package.
    """
    file = folder / LOGS / COMMAND_FILE
    if file.is_file() and is_harmless(command := file.read_text(errors="replace").strip()):
        return command
    return f"the command that began the mission, with --out {folder} and --seed {opened.seed}"


def is_harmless(command: str) -> bool:
    """Whether a shell that gets this command runs legpush alone, and legpush no code that the command names."""
    try:
        words = shlex.split(command)
    except ValueError:
        return False
    flags = [word.partition("=")[0].replace("_", "-") for word in words if word.startswith("--")]
    policies = [word for flag, word in pairwise(words) if flag == "--policy"]
    return (
        words[:2] in (["legpush", "run"], ["legpush", "branch"])
        and shlex.join(words) == command == one_line(command)
        and not any(flag in CODE_FLAGS for flag in flags)
        and flags.count("--policy") == len(policies)
        and not any(runs_code(policy) for policy in policies)
    )
