"""Compiles functions with Numba, to the same machine code on every processor, and keeps the result in a cache."""

import hashlib
import os
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, Final

import numba
from numba.core import config as numba_config
from numba.core.registry import cpu_target

from legpush.errors import LegpushError

config: Any = numba_config
"""Numba's settings, which are made when it is imported."""
target: Any = cpu_target
"""What Numba compiles for."""
PROCESSOR: Final = "generic"
"""What LLVM compiles for: no more than every processor of this architecture has, so without fused multiply-add."""


def compiled(*signatures: str) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator that compiles a function for `signatures` at once, or loads it from the cache.

    Without signatures it is compiled as a part of those that call it, and Python calls its `py_func`. Every operation
    is rounded as it is written: nothing is reordered, fused, or given to BLAS or to Intel's vector functions.

    Raises:
        LegpushError: Something in this process has made Numba compile for another processor.
    """
    config.CPU_NAME, config.CPU_FEATURES, config.USING_SVML = PROCESSOR, "", False
    _, processor, features = target.target_context.codegen().magic_tuple()
    if (processor, features) != (PROCESSOR, ""):
        raise LegpushError(
            f"Expected Numba to compile for the processor `{PROCESSOR}`, got another one, which was chosen before "
            "legpush was asked: set NUMBA_CPU_NAME=generic before this process starts"
        )
    if not signatures:
        part: Callable[[Callable[..., Any]], Any] = numba.njit(error_model="numpy")
        return part

    def decorate(function: Callable[..., Any]) -> Any:
        usual, config.CACHE_DIR = config.CACHE_DIR, str(cache_folder())
        try:
            return numba.njit(list(signatures), cache=True, error_model="numpy")(function)
        finally:
            config.CACHE_DIR = usual

    return decorate


@cache
def cache_folder() -> Path:
    """Return the folder of the compiled functions of this version of their source.

    It lies beside the source if that can be written, else where the user keeps caches, else it belongs to this process
    alone. `NUMBA_CACHE_DIR` names another place.
    """
    sources = sorted(Path(__file__).parent.glob("*.py"))
    version = hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()[:12]
    for place in _places():
        folder = place / f"legpush-{version}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        return folder
    return Path(_own_folder().name)


def _places() -> Iterator[Path]:
    if config.CACHE_DIR:
        yield Path(config.CACHE_DIR)
    yield Path(__file__).parent / "__pycache__"
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    if os.path.isabs(caches):
        yield Path(caches)


@cache
def _own_folder() -> "tempfile.TemporaryDirectory[str]":
    """A folder that is removed when this process ends."""
    return tempfile.TemporaryDirectory(prefix="legpush-numba-")
