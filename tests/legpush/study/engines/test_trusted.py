"""Which jobs a worker runs for a head elsewhere: those that are data, and code that its own user has named."""

from pathlib import Path
from typing import Any

import pytest

from legpush import policy_names
from legpush.study.engines.trusted import Trusted, texts
from legpush.study.jobs import Job, Task
from tests.legpush.test_plugins import install

THEIRS = """
[legpush.policies]
their-policy = theirs:make
wide = theirs:make
[legpush.loggers]
their.logger = theirs:make
[legpush.callbacks]
their callback = theirs:make
[legpush.simulators]
their_world = theirs:make
[legpush.tasks]
their_term = theirs:make
[legpush.cells]
their_cell = theirs:make
"""
NAMES = ("their-policy", "their.logger", "their callback", "their_world", "their_term")


def job(kind: str = "push", folder: str | None = None, **specification: Any) -> Job:
    """A job of one cell."""
    task = Task(cell="c", inputs={}, specification=specification, folder=folder)
    return Job(kind=kind, code="x", canary=None, results=None, tasks=(task,))


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        (job("os:system"), "--cell os:system"),
        (job(policy="os:system"), "--policy os:system"),
        (job(changes={"deep": [{"policy": "own.module:make"}]}), "--policy own.module:make"),
        (job(policy="/home/me/model.zip"), "--policy /home/me/model.zip"),
        (job(callbacks=["own:callback"]), "--policy own:callback"),
        (job(policy="my-mod:make"), "--policy my-mod:make"),
        (job(policy="ünit:make"), "--policy ünit:make"),
        (job(policy="1st:make"), "--policy 1st:make"),
        (job(policy="pkg.sub-mod:make"), "--policy pkg.sub-mod:make"),
        (job("training", folder="/tmp/x"), "keep no work in a folder"),
    ],
)
def test_a_job_that_names_code_or_a_folder_is_refused(asked: Job, why: str) -> None:
    assert why in (Trusted().objection(asked) or "")


@pytest.mark.parametrize(
    "asked",
    [
        job(policy="dynamic_programming", scenario={"description": "A note: nothing to run."}),
        job(policy="wide", world="mujoco"),
        job(policy="/home/me/policies/wide"),
    ],
)
def test_a_job_of_data_is_run(asked: Job) -> None:
    assert Trusted().objection(asked) is None


@pytest.mark.parametrize(
    "asked",
    [
        job(policy="their-policy"),
        job("training", loggers=("their.logger",)),
        job("training", callbacks=("their callback",)),
        job(world="their_world"),
        job("training", task={"reward": {"their_term": {}}}),
        job(policy="wide"),
    ],
    ids=["policy", "logger", "callback", "simulator", "term", "name of this package, too"],
)
def test_a_plug_in_of_another_package_is_code_in_every_group(
    asked: Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path, "their-robots", THEIRS)
    monkeypatch.syspath_prepend(tmp_path)
    policy_names._plugins_of_others.cache_clear()
    try:
        assert "--policy" in (Trusted().objection(asked) or "")
        assert Trusted(policies=(*NAMES, "wide")).objection(asked) is None
        assert Trusted().objection(job("their_cell", policy="scripted", loggers=("csv",))) is None
    finally:
        policy_names._plugins_of_others.cache_clear()


def test_what_the_user_of_the_host_allows_is_run() -> None:
    assert Trusted(cell="own:cell").objection(job("own:cell")) is None
    assert Trusted(policies=("own:make",)).objection(job(policy="own:make")) is None
    assert Trusted(cell="own:cell").objection(job("own:other")) is not None


def test_texts_are_found_wherever_they_are() -> None:
    assert sorted(texts({"a": "1", "b": ["2", {"c": ("3", 4, None)}]})) == ["1", "2", "3", "a", "b", "c"]
