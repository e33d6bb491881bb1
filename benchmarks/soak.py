"""`python -m benchmarks.soak DIR...`: keeps the results of `legpush bench soak` in `results/soak.json`.

Several folders are put together, such as one of the table and one of the steps. A part that none of them has stays as
it was kept before. Of each cell the state and the time are kept; what went wrong is kept in full.
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
PARTS: Final = {
    "soak": ("summary", "kills", "cells"),
    "soak_steps": ("steps",),
    "soak_training": ("training",),
}
"""The parts of the results by the names under which the file says how they were made."""


def found_in(folders: Sequence[Path]) -> dict[str, Any]:
    """Return what is kept of the results of all folders, by part.

    Raises:
        ConfigError: A folder has no results.
    """
    found: dict[str, Any] = {"made": {}}
    for folder in folders:
        if not (folder / RESULTS_FILE).exists():
            raise ConfigError(f"Expected the folder of a soak, with {RESULTS_FILE} in it, got {folder}")
        results = read_results(folder)
        results.summarize()
        for part, names in PARTS.items():
            values = kept(results)
            if values[names[-1]]:
                found |= {name: values[name] for name in names}
                found["made"][part] = next(iter(results.made.values()))
    return found


def with_before(found: dict[str, Any], before: dict[str, Any]) -> dict[str, Any]:
    """Return the results with those parts of the ones before that they lack."""
    made: dict[str, Any] = {}
    parts: dict[str, Any] = {}
    for part, names in PARTS.items():
        source = found if part in found["made"] else before
        if part in source.get("made", {}):
            made[part] = source["made"][part]
            parts |= {name: source[name] for name in names}
    return {"made": made, **parts}


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
    before = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    write_whole(RESULT, f"{json.dumps(with_before(found_in(folders), before), indent=1)}\n".encode())
    print(f"kept {RESULT}")
    return 0


if __name__ == "__main__":
    sys.exit(tyro.cli(main))
