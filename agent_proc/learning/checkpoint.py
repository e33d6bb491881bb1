"""The checkpoint of a training: one file of plain data, whole or absent, with a digest that detects damage."""

import hashlib
import re
from pathlib import Path
from typing import Final

import msgspec
from msgspec import Struct

from agent_proc.learning.learner_state import LearnerState
from agent_proc.policies.card import Check, CurvePoint
from agent_proc.policies.reach import Visits
from legpush.errors import LegpushError
from legpush.files import write_whole

CHECKPOINT_FILE: Final = "checkpoint"
"""In the folder of a training."""
FORMAT: Final = 4
"""To be raised when a field of a checkpoint changes."""
MAGIC: Final = b"legpush training checkpoint %d\n" % FORMAT
HEADER: Final = re.compile(rb"legpush training checkpoint (\d{1,9})\n")
"""The header of a checkpoint of any format."""
N_DIGEST: Final = hashlib.sha256().digest_size


class CheckpointError(LegpushError):
    """A checkpoint from which no training can resume; names the file."""

    exit_code = 2


class Checkpoint(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """State of a training between two rollouts."""

    step: int
    learner: LearnerState
    curve: tuple[CurvePoint, ...]
    checks: tuple[Check, ...]
    """Evaluations up to now."""
    best: Check | None
    visits: Visits
    """How far off the box was up to now."""


def save_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write the checkpoint in place of the previous one.

    Raises:
        DiskError: It cannot be written; the previous one is untouched.
    """
    body = msgspec.msgpack.encode(checkpoint)
    write_whole(path, MAGIC + hashlib.sha256(body).digest() + body)


def load_checkpoint(path: Path) -> Checkpoint:
    """Read a checkpoint.

    Raises:
        CheckpointError: It is missing, damaged, or of another format.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise CheckpointError(f"{path}: expected the checkpoint of a training ({error.strerror})") from error
    header = HEADER.match(data)
    if header and int(header[1]) != FORMAT:
        raise CheckpointError(
            f"{path}: expected a checkpoint of format {FORMAT}, got format {int(header[1])}, which another version of "
            "legpush wrote: resume this training with that version, or start it again in a new folder"
        )
    head = len(MAGIC) + N_DIGEST
    if not data.startswith(MAGIC) or hashlib.sha256(data[head:]).digest() != data[len(MAGIC) : head]:
        raise CheckpointError(f"{path}: expected the whole checkpoint of a training, got {len(data)} other bytes")
    try:
        return msgspec.msgpack.decode(data[head:], type=Checkpoint)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise CheckpointError(f"{path}: expected the checkpoint of a training ({error})") from error
