"""A training folder from elsewhere: its checkpoint holds data alone, and resuming from it runs no code of its."""

import hashlib
import pickle
from pathlib import Path

import msgspec
import pytest

from agent_proc.learning.checkpoint import CHECKPOINT_FILE, FORMAT, MAGIC, CheckpointError
from tests.agent.learning.small_training import make_training, small_profile
from tests.security.evil import RAN, Bomb, marks, weights_of_bombs

BOMB = pickle.dumps(Bomb())
BODIES = {
    "pickle": BOMB,
    "weights of PyTorch": weights_of_bombs(),
    "pickle in a field": msgspec.msgpack.encode({"step": 1, "learner": BOMB, "curve": [], "checks": [], "best": None}),
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory of the test, in which a training was interrupted."""
    monkeypatch.chdir(tmp_path)
    make_training(tmp_path, small_profile(steps=32)).run()
    return tmp_path


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize("number", [2, FORMAT])
def test_code_in_a_checkpoint_is_not_run(folder: Path, number: int, body: bytes) -> None:
    header = b"legpush training checkpoint %d\n" % number
    (folder / CHECKPOINT_FILE).write_bytes(header + hashlib.sha256(body).digest() + body)

    with pytest.raises(CheckpointError):
        make_training(folder, small_profile(steps=32)).resume()
    assert marks(folder) == set()
    pickle.loads(BOMB)
    assert marks(folder) == {RAN}, "the bomb does not work"


def test_a_checkpoint_holds_no_pickle(folder: Path) -> None:
    data = (folder / CHECKPOINT_FILE).read_bytes()[len(MAGIC) + hashlib.sha256().digest_size :]

    plain = msgspec.msgpack.decode(data)

    assert plain["step"] == 32
    with pytest.raises((pickle.UnpicklingError, EOFError, ValueError, IndexError, KeyError, AttributeError)):
        pickle.loads(data)
