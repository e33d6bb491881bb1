"""Reports of benchmarks: JSON files in `results/` that say with which machine, versions and command they were made."""

import json
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import msgspec

from experiments.keep import commit, machine
from experiments.rows import Made
from legpush.files import write_whole
from legpush.study.identity import study_versions

RESULTS: Final = Path(__file__).parent / "results"


def write_report(name: str, numbers: Mapping[str, Any]) -> Path:
    """Write the numbers of the running program to `results/NAME.json`, print them, and return the path.

    Raises:
        DiskError: The file cannot be written.
    """
    made = {key: value for key, value in msgspec.structs.asdict(made_here()).items() if value}
    text = json.dumps({"made": {name: made}, **numbers}, indent=1)
    path = RESULTS / f"{name}.json"
    write_whole(path, f"{text}\n".encode())
    print(json.dumps(numbers, indent=1))
    return path


def made_here() -> Made:
    """Return how the numbers of this program are made."""
    versions = study_versions()
    return Made(
        version=versions.get("legpush") or "?",
        commit=commit(),
        command=shlex.join(["python", *sys.orig_argv[1:]]),
        machine=machine(),
        versions=versions,
    )
