"""Checkpoints: one comes back as it was saved, and a damaged, foreign or missing one is refused."""

import hashlib
import pickle
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from agent_proc.learning.checkpoint import FORMAT, MAGIC, Checkpoint, CheckpointError, load_checkpoint, save_checkpoint
from agent_proc.learning.learner_state import capture
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.policies.card import Check, CurvePoint
from agent_proc.policies.reach import Visits
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.learning.small_training import learned, small_profile
from tests.agent.tasks import tuned

CHECK = Check(step=64, seeds=(1, 2), success_rate=0.5, position_error_m=0.02, angle_error_deg=1.5, falls=0, cycles=20.0)
POINT = CurvePoint(step=3, episode_return=-1.5, length=3, success=False, position_error_m=0.4, angle_error_deg=9.0)
VISITS = Visits(turned=(3,) * 180)
TASK = tuned(scenario=scenario_at_station(), max_steps=5)


@pytest.fixture(scope="module")
def checkpoint() -> Checkpoint:
    """A checkpoint of a learner after some steps."""
    env = PushVecEnv(TASK, [FakeWorld()])
    state = capture(learned(small_profile(), env, 32))
    env.close()
    return Checkpoint(step=70, learner=state, curve=(POINT,), checks=(CHECK,), best=CHECK, visits=VISITS)


@pytest.fixture
def path(tmp_path: Path, checkpoint: Checkpoint) -> Path:
    """The file of the checkpoint."""
    path = tmp_path / "checkpoint"
    save_checkpoint(path, checkpoint)
    return path


def test_a_checkpoint_comes_back_as_it_was_saved(path: Path, checkpoint: Checkpoint) -> None:
    assert load_checkpoint(path) == checkpoint


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[:-1],
        lambda data: b"",
        lambda data: data[: len(MAGIC) - 1],
        lambda data: data[:-1] + b"?",
        lambda data: b"?" + data[1:],
    ],
    ids=["cut", "empty", "half a header", "last byte", "first byte"],
)
def test_a_damaged_checkpoint_is_refused(path: Path, damage: Callable[[bytes], bytes]) -> None:
    path.write_bytes(damage(path.read_bytes()))

    with pytest.raises(
        CheckpointError, match=r"checkpoint: expected the whole checkpoint of a training, got \d+ other"
    ):
        load_checkpoint(path)


@pytest.mark.parametrize("other", [FORMAT - 1, FORMAT + 1])
def test_a_checkpoint_of_another_format_is_refused_with_what_to_do(path: Path, other: int) -> None:
    data = path.read_bytes()
    path.write_bytes(b"legpush training checkpoint %d\n" % other + data[len(MAGIC) :])

    with pytest.raises(
        CheckpointError,
        match=rf"checkpoint: expected a checkpoint of format {FORMAT}, got format {other}.*"
        "resume this training with that version, or start it again in a new folder",
    ):
        load_checkpoint(path)


@pytest.mark.parametrize("earlier", [1, 2])
def test_a_pickle_of_an_earlier_format_is_known_as_such(path: Path, earlier: int) -> None:
    body = pickle.dumps({"step": 70})
    path.write_bytes(b"legpush training checkpoint %d\n" % earlier + hashlib.sha256(body).digest() + body)

    with pytest.raises(
        CheckpointError, match=f"got format {earlier}, which another version of legpush wrote"
    ) as caught:
        load_checkpoint(path)
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    "body",
    [b"", b"\xc1", b"\x80", b"\x91" * 10**5, pickle.dumps({"step": 70}), msgspec.msgpack.encode({"step": "70"})],
    ids=["nothing", "no MessagePack", "no field", "deep", "pickle", "wrong type"],
)
def test_a_whole_checkpoint_of_other_data_is_refused(path: Path, body: bytes) -> None:
    path.write_bytes(MAGIC + hashlib.sha256(body).digest() + body)

    with pytest.raises(CheckpointError, match="checkpoint: expected the checkpoint of a training"):
        load_checkpoint(path)


def test_a_missing_checkpoint_is_named(tmp_path: Path) -> None:
    with pytest.raises(CheckpointError, match=r"none: expected the checkpoint of a training \(No such file"):
        load_checkpoint(tmp_path / "none")
