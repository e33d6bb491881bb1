"""Results of the runs of a benchmark, kept as they come: it can be interrupted, and the same command goes on."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Final, TypeVar

import msgspec

from legpush.files import write_whole
from legpush.study.identity import code_version, versions_hash

RUNS: Final = Path("runs") / "benchmarks"
"""Below the folder in which the benchmark is started."""
N_DIGITS: Final = 16
T = TypeVar("T")


class Kept:
    """The results of one benchmark with one version of the code and of the installed packages.

    Results of other versions stay where they are, and are not used.
    """

    def __init__(self, name: str, sources: Path, runs: Path = RUNS) -> None:
        """Keep results in a folder of `runs`. `sources` is the folder with the code of the benchmark."""
        digest = hashlib.sha256(f"{code_version('')} {versions_hash()}".encode())
        for path in sorted(sources.glob("*.py")):
            digest.update(path.read_bytes())
        self.folder = runs / f"{name}-{digest.hexdigest()[:N_DIGITS]}"
        """One file per result."""
        self.folder.mkdir(parents=True, exist_ok=True)

    def result(self, key: str, kind: type[T], make: Callable[[], T]) -> T:
        """Return the result of a run, which is made now unless it is kept already. `key` says which run it is.

        Raises:
            DiskError: It cannot be kept.
        """
        path = self.folder / f"{hashlib.sha256(key.encode()).hexdigest()[:N_DIGITS]}.msgpack"
        if path.exists():
            return msgspec.msgpack.decode(path.read_bytes(), type=kind)
        made = make()
        write_whole(path, msgspec.msgpack.encode(made))
        return made
