"""The checkpoint of a training: one file, complete or not there, which is refused where a byte of it is wrong."""

import hashlib
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from agent_proc.policies.folder import Check, CurvePoint
from legpush.errors import LegpushError
from legpush.files import write_whole

MAGIC: Final = b"legpush training checkpoint 1\n"
N_DIGEST: Final = hashlib.sha256().digest_size


class CheckpointError(LegpushError):
    """A checkpoint that cannot be gone on from; names the file."""

    exit_code = 2


@dataclass(frozen=True, kw_only=True)
class Checkpoint:
    """Where a training is."""

    step: int
    learner: bytes
    """As `learner.capture` returns it."""
    curve: tuple[CurvePoint, ...]
    checks: tuple[Check, ...]
    """Evaluations up to now."""
    best: Check | None


def save_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write it in place of the previous one, which stays where that fails (`DiskError`)."""
    body = pickle.dumps(checkpoint)
    write_whole(path, MAGIC + hashlib.sha256(body).digest() + body)


def load_checkpoint(path: Path) -> Checkpoint:
    """Read it; load only what your own training wrote, for it may hold code. `CheckpointError` where it is damaged."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise CheckpointError(f"{path}: expected the checkpoint of a training ({error.strerror})") from error
    head = len(MAGIC) + N_DIGEST
    if not data.startswith(MAGIC) or hashlib.sha256(data[head:]).digest() != data[len(MAGIC) : head]:
        raise CheckpointError(f"{path}: expected the whole checkpoint of a training, got {len(data)} other bytes")
    checkpoint: Checkpoint = pickle.loads(data[head:])  # noqa: S301 - one's own, and whole
    return checkpoint
