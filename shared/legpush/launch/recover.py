"""`legpush recover`: makes a whole recording of a damaged one, or a journal that goes on of a damaged one."""

import sys
from pathlib import Path

from legpush.errors import ConfigError
from legpush.history.journal import Opened
from legpush.history.mending import step_back
from legpush.options.recordings import RecoverOptions
from legpush.recording.recover import recover
from legpush.runs.folder import COMMAND_FILE, LOGS, journals, own_folder


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
    recording = recover(options.file, out)
    notes = recording.completeness["notes"].splitlines()
    sys.stdout.write(f"wrote {out}: {len(recording.messages)} messages\n" + "".join(f"    {note}\n" for note in notes))
    return 0


def _recover_run(folder: Path) -> int:
    """Cut off the journals of a run at their first damage, and say how the mission goes on."""
    found = journals(folder)
    if not found:
        raise ConfigError(f"Expected a recording, or the folder of a run with a journal in it, got {folder}")
    with own_folder(folder):
        for journal in found:
            opened, done = step_back(journal)
            sys.stdout.write(f"{done}\nto go on: {_command(folder, opened)}\n")
    return 0


def _command(folder: Path, opened: Opened) -> str:
    """Return the command with which the mission goes on."""
    file = folder / LOGS / COMMAND_FILE
    if file.exists():
        return file.read_text().strip()
    return f"the command that began the mission, with --out {folder} and --seed {opened.seed}"
