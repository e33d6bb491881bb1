"""The checkpoint of a training: one file, whole or absent, with a digest that detects damage."""

import hashlib
import pickle
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from agent_proc.policies.folder import Check, CurvePoint
from legpush.errors import LegpushError
from legpush.files import write_whole

FORMAT: Final = 2
"""To be raised when a class that a checkpoint pickles moves or changes."""
MAGIC: Final = b"legpush training checkpoint %d\n" % FORMAT
HEADER: Final = re.compile(rb"legpush training checkpoint (\d{1,9})\n")
"""The header of a checkpoint of any format."""
N_DIGEST: Final = hashlib.sha256().digest_size


class CheckpointError(LegpushError):
    """A checkpoint from which no training can resume; names the file."""

    exit_code = 2


@dataclass(frozen=True, kw_only=True)
class Checkpoint:
    """State of a training between two rollouts."""

    step: int
    learner: bytes
    """The result of `learner.capture`."""
    curve: tuple[CurvePoint, ...]
    checks: tuple[Check, ...]
    """Evaluations up to now."""
    best: Check | None


def save_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write the checkpoint in place of the previous one.

    Raises:
        DiskError: It cannot be written; the previous one is untouched.
    """
    body = pickle.dumps(checkpoint)
    write_whole(path, MAGIC + hashlib.sha256(body).digest() + body)


def load_checkpoint(path: Path) -> Checkpoint:
    """Read a checkpoint; load only files of your own trainings, since they may contain code.

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
    checkpoint: Checkpoint = pickle.loads(data[head:])  # noqa: S301 - of the user's own training, and undamaged
    return checkpoint
