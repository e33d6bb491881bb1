"""`python -m benchmarks.soak DIR...`: keeps the results of `legpush bench soak` in `results/soak.json`.

Several folders are put together, such as one of the table and one of the steps. Of each cell the state and the time are
kept; what went wrong is kept in full.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Final

import msgspec
import tyro

from benchmarks.report import RESULTS
from legpush.errors import ConfigError
from legpush.files import write_whole
from legpush.soak.results import RESULTS_FILE, SoakResults, read_results

RESULT: Final = RESULTS / "soak.json"


def together(folders: Sequence[Path]) -> SoakResults:
    """Return the results of all folders as one.

    Raises:
        ConfigError: A folder has no results.
    """
    found: SoakResults | None = None
    for folder in folders:
        if not (folder / RESULTS_FILE).exists():
            raise ConfigError(f"Expected the folder of a soak, with {RESULTS_FILE} in it, got {folder}")
        results = read_results(folder)
        if found is None:
            found = results
            continue
        found.cells += results.cells
        found.steps += results.steps
        found.training = results.training or found.training
        found.made |= {f"soak_{number}": made for number, made in enumerate(results.made.values(), len(found.made) + 1)}
    if found is None:
        raise ConfigError("Expected the folder of a soak, got none")
    found.summarize()
    return found


def kept(results: SoakResults) -> dict[str, Any]:
    """Return what is kept of the results."""
    plain: dict[str, Any] = msgspec.to_builtins(results)
    cells = {
        f"{cell.name}, seed {cell.seed}": f"{cell.state_crc} in {cell.took_s:g} s"
        if cell.is_as_expected
        else plain["cells"][number]
        for number, cell in enumerate(results.cells)
    }
    return {**plain, "cells": cells}


def main(folders: Annotated[tyro.conf.Positional[tuple[Path, ...]], tyro.conf.arg(metavar="DIR")]) -> int:
    """Keep the results of these soaks."""
    write_whole(RESULT, f"{json.dumps(kept(together(folders)), indent=1)}\n".encode())
    print(f"kept {RESULT}")
    return 0


if __name__ == "__main__":
    sys.exit(tyro.cli(main))
