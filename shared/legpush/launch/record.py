"""`legpush record`, which is also the recorder process of a run."""

import logging
import sys
from dataclasses import asdict, replace
from time import time

from legpush.bus.bus import Bus
from legpush.bus.endpoints import local
from legpush.bus.secure.host_folder import credentials_of
from legpush.errors import printable
from legpush.messages.common import PROTOCOL_VERSION
from legpush.options.checks import require_writable_file
from legpush.options.recordings import RecordOptions
from legpush.output.reply import document
from legpush.recording.mcap_file.writer import RecordingFile, Split
from legpush.recording.recorder import Wanted, record
from legpush.runs.choose_run import choose_run, through_routers
from legpush.service import run_command, start_log, stop_on_signals
from legpush.versions import recorder_versions

log = logging.getLogger(__name__)


def run_recorder(options: RecordOptions) -> int:
    """Record, and return the exit code: 0 if the recording is complete, 1 if not."""
    require_writable_file(options.file, "FILE")
    # With --listen, the processes are started by hand.
    credentials = credentials_of(options.secure, "recorder")
    usual = local("recorder", credentials).connect if options.listen else ()
    if options.router:
        chosen = through_routers(options.run, options.router, credentials)
    else:
        chosen = choose_run(options.run, options.connect or usual, credentials)
    at = replace(chosen.endpoints, listen=options.listen)
    stop = stop_on_signals()
    start_log(f"recorder/{options.name}", "warning" if options.output.quiet else "info")
    about = {
        **dict(item.split("=", 1) for item in options.about),
        "run": chosen.run,
        "protocol": str(PROTOCOL_VERSION),
        "began_unix_s": f"{time():.3f}",
        "topics": " ".join(options.topics),
        **{f"version_{name}": version for name, version in recorder_versions().items()},
    }
    mb = 1_000_000
    split = Split(None if options.split_mb is None else round(mb * options.split_mb), options.split_s)
    log.info("recording run %s", chosen)
    if chosen.launched is None and not (options.connect or options.router):
        log.info("no launcher runs it: waiting for processes that are started by hand")
    file = RecordingFile(options.file, about, split)
    try:
        with Bus(chosen.run, "recorder", options.name, at, stop=stop) as bus:
            wanted = Wanted(topics=options.topics, duration_s=options.duration_s)
            completeness = record(bus, file, wanted, stop)
    except BaseException:
        file.abandon()
        raise
    word = "complete" if completeness.complete else "NOT COMPLETE"
    sys.stdout.write(f"wrote {', '.join(map(str, file.parts))}: {completeness.n_recorded} messages, {word}\n")
    sys.stdout.write(printable("".join(f"    {note}\n" for note in completeness.notes)))
    document({"files": file.parts, **asdict(completeness)})
    return 0 if completeness.complete else 1


def main() -> int:
    """Run the recorder that a launcher starts."""
    # The exit code says whether the recording is complete.
    return run_command("record", RecordOptions, run_recorder, decides=False)
