"""`legpush train`: a training in its folder, interrupted and resumed."""

import errno
import io
import json
import os
import threading
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.learning.plan_file import read_plan
from agent_proc.policies.folder import read_policy
from agent_proc.policies.weights_file import encode_weights
from agent_proc.profiles.profile import dump_profile
from agent_proc.programs import train as program
from agent_proc.programs.train import kept_words, train
from agent_proc.simulators import simulators
from agent_proc.task.file import load_task
from legpush.errors import DISK_FULL, INTERRUPTED, ConfigError, PluginError, PolicyError, exit_code_of
from legpush.options.learning import TrainOptions
from tests.agent.learning.small_training import small_profile


@pytest.fixture
def options(tmp_path: Path) -> TrainOptions:
    """A training of 96 steps."""
    profile = tmp_path / "small.toml"
    profile.write_text(dump_profile(small_profile(evaluate_every=96)), encoding="utf-8")
    return TrainOptions(
        profile=str(profile),
        steps=96,
        entry="fixed",
        seed=4,
        mass_kg=(0.1, 0.9),
        simulators=2,
        out=tmp_path / "training",
    )


def said(options: TrainOptions) -> tuple[int, list[str]]:
    """The exit code of a training, and its lines."""
    console = Console(file=io.StringIO(), width=200)
    return train(options, console), console.file.getvalue().splitlines()  # type: ignore[attr-defined]


@pytest.mark.usefixtures("stop")
def test_a_training_leaves_its_plan_and_its_policies(options: TrainOptions) -> None:
    code, lines = said(options)
    folder = options.out
    assert folder is not None

    plan = read_plan(folder)
    assert (plan.seed, plan.n_simulators, plan.task.entry, plan.task.domain.mass_kg) == (4, 2, "fixed", (0.1, 0.9))
    assert plan.profile == small_profile(evaluate_every=96, steps=96)
    assert code == 0
    assert lines[0].startswith("learning ")
    assert lines[-1].startswith("best policy, success ")
    assert lines[-1].endswith(f": {folder / 'best'}")
    card = read_policy(folder / "last").card
    assert (card.task, card.world, card.init, card.command) == (plan.task, "mujoco", None, plan.command)
    command = f"legpush train --simulators 2 --profile {options.profile} --entry fixed --seed 4 --steps 96"
    assert plan.command == f"{command} --mass-kg 0.1 0.9"


@pytest.mark.usefixtures("stop")
def test_another_task_replaces_that_of_the_profile_and_its_entry_is_its_own(
    options: TrainOptions, tmp_path: Path
) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text((files("agent_proc.task") / "builtin" / "paper-learns.toml").read_text().replace("200", "9"))

    assert said(replace(options, task=str(mine), entry=None, mass_kg=None, steps=32))[0] == 0
    folder = options.out
    assert folder is not None
    plan = read_plan(folder)
    assert plan.task == read_policy(folder / "best").card.task == load_task("paper-learns", max_steps=9)


def test_a_training_of_an_earlier_version_is_resumed(options: TrainOptions, stop: threading.Event) -> None:
    folder = options.out
    assert folder is not None
    stop.set()
    assert said(replace(options, mass_kg=None))[0] == INTERRUPTED
    stop.clear()
    config = folder / "config.json"
    plain = json.loads(config.read_text())
    for name in ("mirrored", "scaling", "ending", "description"):
        del plain["task"][name]
    words = {"observation": "relative", "reward": "tuned"}
    plain["task"] |= {**words, "domain": {"mass_kg": None, "distance_m": None}}
    del plain["profile"]["task"]
    plain["profile"] |= words
    config.write_text(json.dumps(plain))

    assert read_plan(folder).profile.task == "tuned"
    assert said(TrainOptions(resume=folder))[0] == 0
    assert list(read_policy(folder / "last").card.task.ending) == ["no_push_helps", "astray"]


@pytest.mark.parametrize(
    ("n_kept", "n_done", "words"),
    [
        (512, 512, "interrupted: 512 steps are kept"),
        (0, 78, "interrupted: 0 steps are kept; 78 more of an unfinished rollout are done again"),
    ],
)
def test_an_interrupt_says_what_is_kept_and_what_is_done_again(n_kept: int, n_done: int, words: str) -> None:
    assert kept_words(n_kept, n_done) == words


def test_an_interrupted_training_says_how_to_go_on_and_then_ends_as_another_one(
    options: TrainOptions, stop: threading.Event, tmp_path: Path
) -> None:
    folder = options.out
    assert folder is not None
    stop.set()
    code, lines = said(options)
    assert code == INTERRUPTED
    assert lines[-1].startswith("interrupted: 0 steps are kept; ")
    assert lines[-1].endswith(f"; to go on: legpush train --resume {folder}")
    stop.clear()

    assert said(TrainOptions(resume=folder))[0] == 0
    assert said(replace(options, out=tmp_path / "other"))[0] == 0
    resumed, other = (read_policy(path / "last") for path in (folder, tmp_path / "other"))
    assert resumed.card.curve == other.card.curve
    assert encode_weights(resumed.layers, resumed.normalizer) == encode_weights(other.layers, other.normalizer)


@pytest.mark.usefixtures("stop")
def test_without_a_folder_it_makes_one_that_is_named_after_profile_entry_and_seed(
    options: TrainOptions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    assert said(replace(options, out=None, steps=32))[0] == 0
    (folder,) = (tmp_path / "runs").iterdir()
    assert folder.name.endswith("-train-small-fixed-seed4")


@pytest.mark.usefixtures("stop")
def test_a_folder_with_something_in_it_is_refused(options: TrainOptions, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"a new or empty folder for --out, got .*; --resume .* goes on in it"):
        train(replace(options, out=tmp_path), Console(file=io.StringIO()))


@pytest.mark.usefixtures("stop")
def test_only_the_folder_of_a_training_can_be_resumed(tmp_path: Path) -> None:
    file = tmp_path / "config.json"
    for text, message in (
        (None, r"the folder of a training for --resume: .*config\.json"),
        ("{", r"the folder of a training for --resume: .*config\.json"),
        ("{}", r"the folder of a training for --resume: .*config\.json"),
        ('{"profile": 3}', r"config\.json: profile: expected the table of a training profile, got 3"),
    ):
        if text is not None:
            file.write_text(text)
        with pytest.raises(ConfigError, match=message):
            train(TrainOptions(resume=tmp_path), Console(file=io.StringIO()))


def test_a_training_in_the_map_is_resumed_there_and_another_begins_with_it(
    options: TrainOptions, stop: threading.Event, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program, "simulators", simulators)
    options = replace(options, world="map", mass_kg=None)
    folder = options.out
    assert folder is not None
    stop.set()
    assert said(options)[0] == INTERRUPTED
    stop.clear()

    assert said(TrainOptions(resume=folder))[0] == 0
    assert said(replace(options, out=tmp_path / "whole"))[0] == 0
    assert (read_plan(folder).world, read_plan(folder).init) == ("map", None)
    resumed, whole = (read_policy(path / "last") for path in (folder, tmp_path / "whole"))
    assert encode_weights(resumed.layers, resumed.normalizer) == encode_weights(whole.layers, whole.normalizer)
    for init in (folder, folder / "last"):
        tuned = replace(options, init=str(init), out=tmp_path / f"from-{init.name}")
        assert said(tuned)[0] == 0
        assert read_plan(tmp_path / f"from-{init.name}").init == str(init)
    for name in ("nothing", "scripted"):
        with pytest.raises(PolicyError, match=rf"\(fixed, variable, wide\) or the folder of one, got '{name}'"):
            said(replace(options, init=name, out=tmp_path / "none"))
    with pytest.raises(PolicyError, match=r"^variable: expected a policy with the hidden layers of this training, "):
        said(replace(options, init="variable", out=tmp_path / "none"))
    with pytest.raises(PluginError, match="Expected a simulator"):
        said(replace(options, world="nothing", out=tmp_path / "none"))
    assert not (tmp_path / "none").exists()


def test_the_plan_of_an_earlier_version_has_no_world(options: TrainOptions, stop: threading.Event) -> None:
    stop.set()
    said(options)
    assert options.out is not None
    file = options.out / "config.json"
    plain = json.loads(file.read_text())
    del plain["world"], plain["init"]
    file.write_text(json.dumps(plain))

    assert (read_plan(options.out).world, read_plan(options.out).init) == ("mujoco", None)


@pytest.mark.usefixtures("stop")
def test_a_full_disk_ends_with_the_command_that_goes_on(options: TrainOptions, monkeypatch: pytest.MonkeyPatch) -> None:
    fsync, n_synced = os.fsync, 0

    def fill(descriptor: int) -> None:
        nonlocal n_synced
        n_synced += 1
        if n_synced > 3:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fsync(descriptor)

    console = Console(file=io.StringIO(), width=200)
    monkeypatch.setattr(os, "fsync", fill)

    assert exit_code_of(lambda: train(options, console)) == DISK_FULL
    assert isinstance(console.file, io.StringIO)
    assert f"after space is made, to go on: legpush train --resume {options.out}\n" in console.file.getvalue()
    monkeypatch.undo()


def test_deep_nesting_in_the_plan_of_a_training_is_refused(tmp_path: Path) -> None:
    (tmp_path / "config.json").write_bytes(b'{"profile":' + b"[" * 10**5)
    with pytest.raises(ConfigError, match="Expected the folder of a training for --resume"):
        read_plan(tmp_path)


def test_a_task_of_missions_is_refused_before_anything_begins(options: TrainOptions) -> None:
    with pytest.raises(ConfigError, match="whole missions: learn it in the environment legpush/PushL4-v2"):
        said(replace(options, task="push-l4", entry=None, mass_kg=None))
    assert options.out is not None
    assert not options.out.exists()


def test_a_training_that_goes_on_gets_no_setting_again(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="without --steps"):
        train(TrainOptions(resume=tmp_path, steps=5120), Console(file=io.StringIO()))


@pytest.mark.usefixtures("stop")
def test_steps_within_a_rollout_are_told(options: TrainOptions) -> None:
    assert options.out is not None
    n = 2 * small_profile().settings.n_steps  # type: ignore[union-attr]
    _, lines = said(replace(options, steps=n + 1))
    assert lines[0] == f"{n + 1} push cycles end within a rollout; it learns from whole ones, from {2 * n}"
    with pytest.raises(ConfigError, match="Expected --workers with a training of several seeds alone, got "):
        said(TrainOptions(resume=options.out, workers=2))
    _, lines = said(replace(options, steps=n, out=options.out.with_name("whole")))
    assert not lines[0].startswith(f"{n} push cycles")
