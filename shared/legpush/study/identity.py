"""Identities: of the code, of the installed versions, and of each cell."""

import hashlib
import platform
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import msgspec

from legpush.policy_names import source_sha256
from legpush.versions import installed_versions

PACKAGES: Final = ("legpush", "planner_proc", "sim_proc", "agent_proc")
COMPILED: Final = "__pycache__"
"""Folder of what Python and Numba compile, also of the files that they are still writing."""
N_DIGITS: Final = 16
"""Hexadecimal digits of a code version and of a hash of versions."""
N_CELL_DIGITS: Final = 32


@cache
def code_version(kind: str) -> str:
    """Return a hash of all source and data files of the installed packages, and of the source of `module:function`.

    Nothing is imported to find it. It is computed once per process.
    """
    digest = hashlib.sha256()
    for package in PACKAGES:
        for path, data in _files(package):
            for part in (path.encode(), data):
                digest.update(len(part).to_bytes(8, "big"))
                digest.update(part)
    if ":" in kind:
        digest.update(source_sha256(kind).encode())
    return digest.hexdigest()[:N_DIGITS]


@cache
def versions_hash() -> str:
    """Return a hash of the versions of Python, of its packages that decide about results, and of the C library."""
    return hashlib.sha256(msgspec.json.encode(study_versions(), order="sorted")).hexdigest()[:N_DIGITS]


def study_versions() -> dict[str, str | None]:
    """Return what is installed here, with the C library, whose functions decide about last digits."""
    return {**installed_versions(), "libc": " ".join(platform.libc_ver()) or None}


def cell_identity(kind: str, specification: Mapping[str, Any], code: str) -> str:
    """Return the identity of a cell: a hash of its kind, its resolved specification and the code version."""
    canonical = msgspec.json.encode({"kind": kind, "specification": specification, "code": code}, order="sorted")
    return hashlib.sha256(canonical).hexdigest()[:N_CELL_DIGITS]


def _files(package: str) -> Iterator[tuple[str, bytes]]:
    """Yield path and content of each file of a package, but for what is compiled; nothing if it is not installed."""
    spec = find_spec(package)
    for place in () if spec is None else spec.submodule_search_locations or ():
        folder = Path(place)
        for path in sorted(folder.rglob("*")):
            place_in_package = path.relative_to(folder)
            if path.is_file() and path.suffix != ".pyc" and COMPILED not in place_in_package.parts:
                yield f"{package}/{place_in_package.as_posix()}", path.read_bytes()
