"""A training whose simulators and learner are killed again and again: it ends with the policy of one left in peace."""

import hashlib
import os
import signal
import subprocess
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack, suppress
from importlib.resources import as_file, files
from math import ceil
from pathlib import Path
from time import monotonic
from typing import Final

import msgspec
import numpy as np
import psutil
from msgspec import Struct

from legpush.errors import PeerError, StopRequestedError
from legpush.files import private_opener, write_whole
from legpush.soak.mission import LEGPUSH
from legpush.soak.resources import Growth, Sample, growths, sample

N_AT_ONCE: Final = 2
"""The disturbed training and the undisturbed one share the machine."""
N_SIMULATORS: Final = 2
ROLLOUT_STEPS: Final = 128
LEAST_ROLLOUTS: Final = 4
"""Of a training."""
PROBE_STEPS: Final = 512
KILL_EVERY_S: Final = 30.0
N_LEARNER_KILLS: Final = 10
SAMPLE_EVERY_S: Final = 5.0
LOOK_S: Final = 0.2
STATE_FILE: Final = "state.json"
COMPARED: Final = ("last/policy.safetensors", "last/card.json", "best/policy.safetensors", "best/card.json")
"""Files of a training that hold every weight, and every episode with its step, return and length."""


class TrainingState(Struct, kw_only=True):
    """How far the trainings are; kept in a file, so that an interrupted soak goes on."""

    n_steps: int = 0
    """Of both trainings of the present round; 0 before it is known how many fit into the time."""
    finished_steps: list[int] = []
    """Of the rounds before, which took less time than was asked for."""
    finished_s: float = 0.0
    """How long the disturbed trainings of these rounds went on."""
    trained_s: float = 0.0
    """How long the disturbed training has gone on."""
    killed_simulators: int = 0
    killed_learners: int = 0
    learner_killed_at_s: float = 0.0
    """When the learner was last killed, on the clock of `trained_s`."""
    samples: dict[str, list[Sample]] = {}
    """Of each process role, since the learner was last started."""
    growth: list[dict[str, Growth | None]] = []
    """Of each stretch between two starts of the learner."""


class TrainingResult(Struct, frozen=True, kw_only=True):
    """What came of the disturbed trainings."""

    hours: float
    n_steps: int
    n_rounds: int = 1
    """Number of pairs of trainings, of which one was disturbed."""
    killed_simulators: int
    killed_learners: int
    same_files: tuple[str, ...]
    different_files: tuple[str, ...]
    growth: tuple[dict[str, Growth | None], ...]

    @property
    def is_same(self) -> bool:
        """Whether the trainings ended as the undisturbed ones."""
        return not self.different_files


class TrainingSoak:
    """Pairs of trainings in a folder, an undisturbed one and one with kills, until the time is over."""

    def __init__(
        self, folder: Path, hours: float, seed: int, stop: threading.Event, tell: Callable[[str], None]
    ) -> None:
        self._folder = folder
        self._hours = hours
        self._seed = seed
        self._stop = stop
        self._failed = threading.Event()
        """Set once one of the trainings cannot go on."""
        self._tell = tell
        self._draw = np.random.default_rng(seed)
        path = folder / STATE_FILE
        self._state = msgspec.json.decode(path.read_bytes(), type=TrainingState) if path.exists() else TrainingState()

    def run(self) -> TrainingResult:
        """Train until the time is over.

        Raises:
            PeerError: A training ended by itself before its end.
            StopRequestedError: `stop` was set; the same soak goes on.
        """
        self._folder.mkdir(parents=True, exist_ok=True)
        state = self._state
        if state.n_steps == 0:
            began_s = monotonic()
            self._train("probe", PROBE_STEPS)
            rate = PROBE_STEPS / (monotonic() - began_s)
            n_rollouts = max(LEAST_ROLLOUTS, round(3600.0 * self._hours * rate / N_AT_ONCE / ROLLOUT_STEPS))
            state.n_steps = ROLLOUT_STEPS * n_rollouts
            self._save()
        while True:
            self._tell(f"two trainings at once, one of them disturbed: {state.n_steps} steps each")
            self._train_both(state.n_steps)
            self._save()
            left_s = 3600.0 * self._hours - state.trained_s
            if left_s <= 0.0 or state.trained_s <= state.finished_s:
                break
            per_step_s = (state.trained_s - state.finished_s) / state.n_steps
            state.finished_steps.append(state.n_steps)
            state.finished_s = state.trained_s
            state.n_steps = ROLLOUT_STEPS * max(LEAST_ROLLOUTS, ceil(left_s / per_step_s / ROLLOUT_STEPS))
            self._save()
        same: list[str] = []
        different: list[str] = []
        n_rounds = len(state.finished_steps) + 1
        for name in COMPARED:
            is_same = all(
                len({_digest(self._place(training, k) / name) for training in ("undisturbed", "disturbed")}) == 1
                for k in range(n_rounds)
            )
            (same if is_same else different).append(name)
        return TrainingResult(
            hours=round(state.trained_s / 3600.0, 3),
            n_steps=sum(state.finished_steps) + state.n_steps,
            n_rounds=n_rounds,
            killed_simulators=state.killed_simulators,
            killed_learners=state.killed_learners,
            same_files=tuple(same),
            different_files=tuple(different),
            growth=tuple(state.growth),
        )

    def _place(self, name: str, n_finished: int) -> Path:
        """Return the folder of a training that begins after `n_finished` pairs."""
        return self._folder / (f"{name}-round-{n_finished + 1}" if n_finished else name)

    def _train_both(self, n_steps: int) -> None:
        """Run both trainings to their ends; what ends one of them ends the other."""
        with ThreadPoolExecutor(N_AT_ONCE) as pool:
            trainings = [
                pool.submit(self._train, "undisturbed", n_steps),
                pool.submit(self._train, "disturbed", n_steps, self._disturb),
            ]
            try:
                for training in as_completed(trainings):
                    training.result()
            except BaseException:
                self._failed.set()
                raise

    def _train(
        self, name: str, n_steps: int, disturb: "Callable[[subprocess.Popen[bytes]], bool] | None" = None
    ) -> None:
        """Run a training to its end, started again for as long as `disturb` kills it."""
        folder = self._place(name, len(self._state.finished_steps))
        while not (folder / "last").exists():
            with open(self._folder / f"{name}.log", "ab", opener=private_opener) as log:
                learner = subprocess.Popen(self._command(folder, n_steps), stdout=log, stderr=subprocess.STDOUT)
            with ExitStack() as stack:
                stack.callback(_end, learner)
                killed = False
                while learner.poll() is None:
                    if self._stop.wait(LOOK_S) or self._failed.is_set():
                        raise StopRequestedError(f"Asked to stop during the training {name}")
                    killed = killed or (disturb is not None and disturb(learner))
            if learner.returncode != 0 and not killed:
                raise PeerError(f"The training {name} ended with {learner.returncode}; see {self._folder}/{name}.log")

    def _command(self, folder: Path, n_steps: int) -> tuple[str, ...]:
        """Begin a training, or go on with it."""
        if (folder / "checkpoint").exists():
            return (*LEGPUSH, "train", "--resume", str(folder))
        if folder.exists():  # it was killed before its first checkpoint
            folder.rename(folder.with_name(f"{folder.name}-{int(folder.stat().st_mtime)}"))
        with as_file(files("legpush.soak") / "training.toml") as profile:
            flags = ("--profile", str(profile), "--steps", str(n_steps))
        seed = str(self._seed + len(self._state.finished_steps))
        return (*LEGPUSH, "train", *flags, "--seed", seed, "--simulators", str(N_SIMULATORS), "--out", str(folder))

    def _disturb(self, learner: "subprocess.Popen[bytes]") -> bool:
        """Kill a simulator every 30 s, and the learner ten times; returns whether it killed the learner."""
        state = self._state
        before_s, state.trained_s = state.trained_s, state.trained_s + LOOK_S
        if _passed(before_s, state.trained_s, SAMPLE_EVERY_S):
            self._sample(learner)
        if _passed(before_s, state.trained_s, KILL_EVERY_S) and (victims := _simulators(learner)):
            with suppress(psutil.NoSuchProcess):
                victims[int(self._draw.integers(len(victims)))].kill()
                state.killed_simulators += 1
                self._save()
        every_s = 3600.0 * self._hours / (N_LEARNER_KILLS + 1)
        folder = self._place("disturbed", len(self._state.finished_steps))
        has_checkpoint = (folder / "checkpoint").exists()
        is_due = state.trained_s >= state.learner_killed_at_s + every_s
        if has_checkpoint and is_due and state.killed_learners < N_LEARNER_KILLS:
            learner.send_signal(signal.SIGKILL)
            state.killed_learners += 1
            state.learner_killed_at_s = state.trained_s
            state.growth.append(growths(state.samples))
            state.samples = {}
            self._save()
            return True
        return False

    def _sample(self, learner: "subprocess.Popen[bytes]") -> None:
        """Note what the learner and its simulators hold; a simulator that was just started is left out."""
        with suppress(psutil.Error):
            process = psutil.Process(learner.pid)
            self._state.samples.setdefault("learner", []).append(sample(process))

    def _save(self) -> None:
        write_whole(self._folder / STATE_FILE, msgspec.json.encode(self._state))


def _passed(before_s: float, now_s: float, every_s: float) -> bool:
    """Whether a multiple of `every_s` lies between the two times."""
    return int(now_s / every_s) > int(before_s / every_s)


def _simulators(learner: "subprocess.Popen[bytes]") -> list[psutil.Process]:
    try:
        children = psutil.Process(learner.pid).children(recursive=True)
        return [child for child in children if "sim_proc" in child.cmdline()]
    except psutil.Error:
        return []


def _end(learner: "subprocess.Popen[bytes]") -> None:
    """End a learner as Ctrl-C does, so that it leaves a checkpoint."""
    if learner.poll() is None:
        learner.send_signal(signal.SIGINT)
        try:
            learner.wait(60.0)
        except subprocess.TimeoutExpired:
            learner.kill()
            learner.wait()


def _digest(path: Path) -> str:
    """The hash of a file, a card without its command, which names the folder; the path of a file that is missing."""
    if not path.exists():
        return os.fspath(path)
    data = path.read_bytes()
    if path.suffix == ".json":
        card = msgspec.json.decode(data)
        data = msgspec.json.encode({key: value for key, value in card.items() if key != "command"})
    return hashlib.sha256(data).hexdigest()
