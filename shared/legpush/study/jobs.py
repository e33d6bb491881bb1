"""What travels between the head of a study and its workers: jobs, and answers with rows."""

from typing import Any

import msgspec
from msgspec import Struct


class Task(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One cell to run."""

    cell: str
    """Its identity."""
    inputs: dict[str, Any]
    """The settings and axes of the cell as columns of its row."""
    specification: dict[str, Any]
    """The resolved specification, as plain values."""
    folder: str | None = None
    """Where the cell keeps its work, and goes on when it is run again; None if it keeps none. No part of its identity:
    the results are the same."""


class Job(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Cells for one worker process; without cells, the worker only says what it is."""

    kind: str
    """A plug-in of the group `legpush.cells`, or `module:function`."""
    code: str
    """The code version of the study; a worker with another one refuses the job."""
    canary: str | None
    """The CRC that the canary must have; None accepts any."""
    results: tuple[str, ...] | None
    """Result columns to keep; None keeps all."""
    tasks: tuple[Task, ...]


class Row(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A cell that was run."""

    cell: str
    columns: dict[str, Any]
    """All columns of the row: inputs, results, and where and how it was computed."""
    wall_s: float
    """From the beginning of the cell to its end."""


class Failure(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A cell that raised an exception."""

    cell: str
    error: str
    """Type and text of the exception."""
    traceback: str


class Answer(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The answer to a job."""

    host: str
    pid: int
    numerics: str
    """Numerics profile of the worker."""
    canary: str | None
    """CRC of the worker's canary; None if the kind of cell has none."""
    refused: str | None = None
    """Why the worker ran nothing; None if it did."""
    rows: tuple[Row, ...] = ()
    failures: tuple[Failure, ...] = ()


def encode(message: Job | Answer) -> bytes:
    """Return a job or an answer as MessagePack; numbers need not be finite."""
    return msgspec.msgpack.encode(message)


def decode_job(payload: bytes) -> Job:
    """Return the job in `payload`.

    Raises:
        msgspec.ValidationError: The payload is no job.
    """
    return msgspec.msgpack.decode(payload, type=Job)


def decode_answer(payload: bytes) -> Answer:
    """Return the answer in `payload`.

    Raises:
        msgspec.ValidationError: The payload is no answer.
    """
    return msgspec.msgpack.decode(payload, type=Answer)
