"""The work of a worker: a job as bytes in, an answer as bytes out. Every engine calls it in its worker processes."""

import os
import platform
import traceback
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import msgspec
from threadpoolctl import threadpool_limits

from legpush.canary import compute, published
from legpush.numerics.current import current
from legpush.study.cells import CellError, CellKind, columns_of, load_kind
from legpush.study.identity import code_version, versions_hash
from legpush.study.jobs import Answer, Failure, Job, Row, Task, decode_job, encode


def work(payload: bytes) -> bytes:
    """Run the cells of a job and return the answer.

    A worker whose code or canary differs from that of the study runs nothing, and says so.

    Raises:
        LegpushError: The kind of cell cannot be loaded.
    """
    job = decode_job(payload)
    kind = _loaded(job.kind)
    own = _canary() if kind.needs_canary else None
    refused = _objection(job, own)
    rows: list[Row] = []
    failures: list[Failure] = []
    for task in () if refused else job.tasks:
        done = _run(job, kind, task)
        if isinstance(done, Row):
            rows.append(done)
        else:
            failures.append(done)
    return encode(
        Answer(
            host=platform.node(),
            pid=os.getpid(),
            numerics=current().name,
            canary=own,
            refused=refused,
            rows=tuple(rows),
            failures=tuple(failures),
        )
    )


@cache
def _canary() -> str:
    """Return the canary of this process, computed once."""
    return compute().crc


@cache
def _loaded(name: str) -> CellKind:
    """Load a kind of cell, and limit this process to one thread, since a sum of several threads is rounded differently.

    Finding the libraries to limit takes milliseconds, so it is done once.
    """
    kind = load_kind(name)
    threadpool_limits(limits=1)
    return kind


def _objection(job: Job, own: str | None) -> str | None:
    """Return why this process must not run the job; None if it may."""
    if (code := code_version(job.kind)) != job.code:
        return f"expected the code version {job.code}, has {code}"
    if job.canary is not None and own != job.canary:
        return f"expected the canary {job.canary}, computes {own} (numerics {current().name})"
    if own is not None and (known := published(current().name)) is not None and known.crc != own:
        return f"expected the published canary {known.crc} for numerics {current().name}, computes {own}"
    return None


def _run(job: Job, kind: CellKind, task: Task) -> Row | Failure:
    began_s, began_cpu_s = perf_counter(), process_time()
    try:
        folder = None if task.folder is None else Path(task.folder)
        results = columns_of(kind, msgspec.convert(task.specification, kind.resolved), folder)
        _require_apart(task.inputs, results)
    except Exception as error:  # noqa: BLE001 - a cell may raise anything; its last words are kept
        return Failure(cell=task.cell, error=f"{type(error).__name__}: {error}", traceback=traceback.format_exc())
    wall_s, cpu_s = perf_counter() - began_s, process_time() - began_cpu_s
    kept = results if job.results is None else {name: results.get(name) for name in (*job.results, "state_crc")}
    columns = {
        "cell": task.cell,
        **task.inputs,
        **kept,
        "state_crc": kept.get("state_crc"),
        "numerics": current().name,
        "code": job.code,
        "versions": versions_hash(),
        "host": platform.node(),
        "cpu_s": cpu_s,
        "wall_s": wall_s,
    }
    return Row(cell=task.cell, columns=columns, wall_s=wall_s)


def _require_apart(inputs: Mapping[str, Any], results: Mapping[str, Any]) -> None:
    if both := inputs.keys() & results.keys():
        raise CellError(f"Expected other names for results than for inputs, got {', '.join(sorted(both))} twice")
