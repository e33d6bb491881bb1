"""`legpush study run`: begins a study, or goes on with it, until every cell has a row or has failed."""

import shlex
import sys
from functools import partial

from rich.console import Console
from rich.text import Text

from legpush.errors import INTERRUPTED
from legpush.options.checks import require_writable_folder
from legpush.options.study import RunStudy
from legpush.output.reply import document
from legpush.service import stop_on_signals
from legpush.study.carry_out import Orders, carry_out
from legpush.study.engines.choose import INLINE, LOCAL, engine_of, require_engine
from legpush.study.file import load_study
from legpush.study.folder import StudyFolder
from legpush.study.progress import line, shown


def run_study(options: RunStudy, console: Console) -> int:
    """Run the study; returns the exit code.

    Raises:
        ConfigError: The file, the folder or the engine cannot be used; nothing was run.
        DiskFullError: The disk is full; what was written before is kept.
        LegpushError: The engine failed.
    """
    require_engine(options.on, options.slurm_options)
    require_writable_folder(options.folder, "--out")
    study = load_study(options.file, own_cell=options.cell, allowed_policies=options.policy, many=options.yes)
    stop, folder = stop_on_signals(), StudyFolder(options.folder)
    again = shlex.join(["legpush", *sys.argv[1:]])
    orders = Orders(
        engine=partial(engine_of, options, stop=stop),
        stop=stop,
        again=again,
        # The first local worker is a process of this machine; on a cluster, this process decides.
        first_decides=options.join is None and options.on in (LOCAL, INLINE),
        retry_failed=options.retry_failed,
        shown=partial(shown, console),
        private=options.out is None,
    )
    tally = carry_out(study, folder.path, orders)
    if stop.is_set():
        console.print(Text(f"interrupted: {line(tally, 0.0)}; to go on: {again}"), soft_wrap=True)
        return INTERRUPTED
    console.print(Text(f"{line(tally, 0.0)}; written to {folder.table}"), soft_wrap=True)
    document({"table": folder.table, "n_cells": tally.n_cells, "n_done": tally.n_done, "n_failed": tally.n_failed})
    if tally.n_failed:
        console.print(Text(f"failed cells have their last words in {folder.failed}"), soft_wrap=True)
        return 1
    return 0
