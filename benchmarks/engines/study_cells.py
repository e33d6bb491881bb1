"""Kinds of cells for benchmarks of studies: they note when they began and ended, and in which process."""

import os
import time
from collections.abc import Mapping
from typing import Any, Final

from msgspec import Struct

from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, as_it_is, load_kind


class Sleep(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A cell that only takes time."""

    index: int
    seconds: float = 0.0


def sleep(cell: Sleep) -> Mapping[str, Any]:
    """Sleep."""
    began_s = time.time()
    if cell.seconds > 0.0:
        time.sleep(cell.seconds)
    return _times(began_s)


def push(cell: Any) -> Mapping[str, Any]:
    """Run an episode of pushes."""
    began_s = time.time()
    row = load_kind("push").run(cell)
    return {**row, **_times(began_s)}


def _times(began_s: float) -> dict[str, Any]:
    return {"pid": os.getpid(), "began_s": began_s, "ended_s": time.time()}


SLEEP: Final = CellKind(specification=Sleep, run=sleep, resolved=Sleep, resolve=as_it_is, needs_canary=False)
"""The stub."""


def __getattr__(name: str) -> CellKind:
    """Return `PUSH`, the kind of cell `push` with the time of each cell; it is loaded when it is asked for."""
    if name != "PUSH":
        raise AttributeError(name)
    kind = load_kind("push")
    return CellKind(
        specification=kind.specification,
        run=push,
        resolved=kind.resolved,
        resolve=kind.resolve,
        changes=Scenario,
    )
