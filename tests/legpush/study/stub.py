"""Kinds of cells for tests: quick ones that need no simulator."""

import os
import time
from collections.abc import Mapping
from typing import Any

from msgspec import Struct

from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column, as_it_is


class StubCell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a stub cell takes."""

    seed: int
    factor: float = 1.0
    seconds: float = 0.0
    """How long to take."""
    fail_every: int = 0
    """Fail in each cell whose seed is a multiple of this."""
    kill_at: int = -1
    """End the worker process in the cell with this seed."""
    changes: dict[str, Any] = {}


def run(cell: StubCell) -> Mapping[str, Any]:
    """Compute something of the seed."""
    if cell.fail_every and cell.seed % cell.fail_every == 0:
        raise ValueError(f"seed {cell.seed} is a multiple of {cell.fail_every}")
    if cell.seed == cell.kill_at:
        os._exit(7)
    end_s = time.perf_counter() + cell.seconds
    time.sleep(cell.seconds)
    return {
        "value": cell.factor * cell.seed,
        "odd": bool(cell.seed % 2),
        "track": [cell.seed, cell.seed + 1],
        "took_s": time.perf_counter() - end_s,
        "state_crc": f"{cell.seed * 2654435761 % 2**32:08x}",
    }


STUB = CellKind(
    specification=StubCell,
    run=run,
    resolved=StubCell,
    resolve=as_it_is,
    columns=(
        Column(name="value", unit="m", about="factor times seed"),
        Column(name="odd", unit="", about="whether the seed is odd"),
        Column(name="track", unit="", about="two numbers"),
        Column(name="took_s", unit="s", about="time that the cell took too long", may_differ=True),
        Column(name="state_crc", unit="", about="a number made of the seed"),
    ),
    changes=Scenario,
    needs_canary=False,
)


def double(seed: int, factor: float = 2.0) -> dict[str, Any]:
    """A kind of cell as a user writes it."""
    return {"value": factor * seed}
