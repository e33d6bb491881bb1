"""Trainings that are killed: a stand-in for `legpush train` shows that kills, resuming and comparing work."""

import sys
import threading
from pathlib import Path

import pytest

from legpush.errors import PeerError, StopRequestedError
from legpush.soak import training
from legpush.soak.training import COMPARED, TrainingSoak

TRAIN = """
import json, subprocess, sys, time
from pathlib import Path
words = dict(zip(sys.argv[2::2], sys.argv[3::2]))
folder = Path(words.get("--resume") or words["--out"])
checkpoint = folder / "checkpoint"
folder.mkdir(exist_ok=True)
simulator = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)", "sim_proc"])
try:
    if folder.name == "probe":
        time.sleep(0.3)
    for step in range(int(checkpoint.read_text()) if checkpoint.exists() else 0, 40):
        part = folder / "checkpoint.part"
        part.write_text(str(step))
        part.replace(checkpoint)
        time.sleep(0.05 if folder.name == "disturbed" else 0.0)
    for name in NAMES:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(json.dumps({"command": name[-4:] == "json" and str(folder), "weights": WEIGHTS}))
finally:
    simulator.kill()
"""


@pytest.fixture
def trainer(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """A quick stand-in, which is killed often."""
    for name, value in (("LOOK_S", 0.01), ("KILL_EVERY_S", 0.05), ("SAMPLE_EVERY_S", 0.02), ("N_LEARNER_KILLS", 3)):
        monkeypatch.setattr(training, name, value)
    use(monkeypatch, "'x'")
    return monkeypatch


def use(monkeypatch: pytest.MonkeyPatch, weights: str, names: tuple[str, ...] = COMPARED) -> None:
    program = TRAIN.replace("NAMES", repr(names)).replace("WEIGHTS", weights)
    monkeypatch.setattr(training, "LEGPUSH", (sys.executable, "-c", program))


def soak(folder: Path, stop: threading.Event | None = None) -> TrainingSoak:
    return TrainingSoak(folder, 0.5 / 3600, 0, stop or threading.Event(), lambda text: None)


def test_a_training_that_is_killed_and_resumed_is_compared_with_one_left_in_peace(
    tmp_path: Path, trainer: pytest.MonkeyPatch
) -> None:
    result = soak(tmp_path).run()
    assert result.is_same
    assert result.killed_learners == 3
    assert result.killed_simulators >= 1
    assert len(result.growth) == 3
    assert result.n_steps >= 512


def test_more_trainings_follow_until_the_time_is_over(tmp_path: Path, trainer: pytest.MonkeyPatch) -> None:
    result = TrainingSoak(tmp_path, 3.0 / 3600, 0, threading.Event(), lambda text: None).run()
    assert result.n_rounds >= 2
    assert result.hours >= 2.9 / 3600
    assert result.is_same
    (tmp_path / f"disturbed-round-{result.n_rounds}" / COMPARED[0]).write_text("{}")
    assert (
        TrainingSoak(tmp_path, 3.0 / 3600, 0, threading.Event(), lambda text: None).run().different_files
        == (COMPARED[:1])
    )


def test_other_weights_are_found(tmp_path: Path, trainer: pytest.MonkeyPatch) -> None:
    use(trainer, "folder.name")
    result = soak(tmp_path).run()
    assert result.different_files == COMPARED
    assert not result.is_same


def test_files_that_are_missing_are_not_the_same(tmp_path: Path, trainer: pytest.MonkeyPatch) -> None:
    use(trainer, "'x'", COMPARED[:1])
    assert soak(tmp_path).run().different_files == COMPARED[1:]


def test_it_goes_on_where_it_was_interrupted(tmp_path: Path, trainer: pytest.MonkeyPatch) -> None:
    stop = threading.Event()
    stop.set()
    with pytest.raises(StopRequestedError):
        soak(tmp_path, stop).run()
    first = soak(tmp_path).run()
    again = soak(tmp_path).run()
    assert again.n_steps == first.n_steps
    assert again.killed_learners == first.killed_learners == 3


def test_a_training_that_fails_by_itself_is_told_with_its_log(tmp_path: Path, trainer: pytest.MonkeyPatch) -> None:
    trainer.setattr(training, "LEGPUSH", (sys.executable, "-c", "raise SystemExit(2)"))
    with pytest.raises(PeerError, match=r"training probe ended with 2; see .*probe\.log"):
        soak(tmp_path).run()


def test_a_training_that_fails_ends_the_other_one(tmp_path: Path, trainer: pytest.MonkeyPatch) -> None:
    program = "import pathlib, sys, time; name = pathlib.Path(sys.argv[-1]).name; "
    program += "sys.exit(2 if name == 'undisturbed' else 0 if name == 'probe' else time.sleep(15))"
    trainer.setattr(training, "LEGPUSH", (sys.executable, "-c", program))
    (tmp_path / "probe" / "last").mkdir(parents=True)
    with pytest.raises(PeerError, match=r"training undisturbed ended with 2; see .*undisturbed\.log"):
        soak(tmp_path).run()
