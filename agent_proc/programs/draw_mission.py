"""Pictures of missions as a program: `legpush picture DIR`."""

import sys

from agent_proc.endings import MissionResult
from agent_proc.reporting.mission_picture.picture import save_picture
from agent_proc.reporting.mission_record import read_record
from legpush.errors import ConfigError
from legpush.history.steps import read_episode
from legpush.options.maps import PictureOptions
from legpush.output.reply import document
from legpush.runs.folder import journals
from legpush.runs.report import read_report
from legpush.service import run_command


def main() -> int:
    """Parse the command line and draw; returns the exit code."""
    return run_command("picture", PictureOptions, run)


def run(options: PictureOptions) -> int:
    """Draw the mission from its journal and its report; returns the exit code.

    Raises:
        ConfigError: The folder is not that of one mission, or the picture cannot be written.
        LegpushError: The journal or the report cannot be read.
    """
    found, picture = journals(options.run_folder), options.target()
    if len(found) != 1:
        raise ConfigError(f"{options.run_folder}: expected the journal of one mission, got {len(found)}")
    report = read_report(options.run_folder)
    fields = ("success", "reason", "detail", "remedy", "handover_distance_m", "n_push_cycles", "n_replans")
    if missing := [name for name in fields if name not in report]:
        raise ConfigError(f"{options.run_folder}: expected a report with {', '.join(fields)}, got none of {missing[0]}")
    result = MissionResult(n_better_paths=report.get("n_better_paths", 0), **{name: report[name] for name in fields})
    try:
        save_picture(read_record(read_episode(found[0])), result, picture)
    except OSError as error:
        raise ConfigError(f"{picture}: expected a file that can be written ({error.strerror})") from error
    sys.stdout.write(f"wrote {picture}\n")
    document({"picture": picture})
    return 0
