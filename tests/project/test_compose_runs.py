"""The services of `compose.yaml` do what they are for, each with its command as it stands."""

import json
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from time import monotonic, sleep
from typing import Final

import pytest

from agent_proc.profiles.profile import dump_profile
from legpush.recording.mcap_file.reader import read_recording
from tests.agent.learning.small_training import small_profile
from tests.project.composed import Contained, OnThisMachine, Service, read_compose

LIMIT_S: Final = 240.0
IS_ROOT: Final = os.getuid() == 0 and all(map(shutil.which, ("ip", "unshare", "setpriv")))
"""Namespaces need root and util-linux."""
PLACES: Final = [OnThisMachine, Contained] if IS_ROOT else [OnThisMachine]
MISSION: Final = ("router", "planner", "sim", "recorder", "viewer")
"""What is up before the agent is started."""


STUDY_FILE: Final = """
name = "small"
cell = "push"

[settings]
policy = "scripted"

[axes]
seed = [1, 2]
"""


class Stack:
    """Services that run, with their logs."""

    def __init__(self, place: OnThisMachine | Contained, services: dict[str, Service], folder: Path) -> None:
        self._place, self._services, self._folder = place, services, folder
        self._running = ExitStack()

    def __enter__(self) -> "Stack":
        return self

    def __exit__(self, *_: object) -> None:
        self._running.close()
        self._place.end()

    def log(self, name: str, copy: int = 0) -> str:
        """What a service has written."""
        return (self._folder / f"{name}-{copy}.log").read_text()

    def start(self, name: str, copy: int = 0) -> "subprocess.Popen[bytes]":
        """Start a service that does not outlive the test."""
        words = self._place.words(name, self._services[name]["command"], copy)
        with (self._folder / f"{name}-{copy}.log").open("wb") as log:
            process = subprocess.Popen(
                words, cwd=self._folder, env=self._place.environment(name), stdout=log, stderr=subprocess.STDOUT
            )
        self._running.callback(process.wait)
        self._running.callback(process.kill)
        return process

    def is_healthy(self, name: str, copy: int = 0) -> bool:
        """What the health check of a service says, as soon as it is good, and at last."""
        kind, *command = self._services[name]["healthcheck"]["test"]
        words = self._place.words(name, ["sh", "-c", *command] if kind == "CMD-SHELL" else command, copy)
        until = monotonic() + LIMIT_S
        while True:
            asked = subprocess.run(
                words, cwd=self._folder, env=self._place.environment(name), capture_output=True, check=False
            )
            if asked.returncode == 0 or monotonic() > until:
                return asked.returncode == 0
            sleep(0.2)


@pytest.fixture(params=PLACES)
def stack(request: pytest.FixtureRequest, root: Path, tmp_path: Path) -> Iterator[Stack]:
    """Services with certificates, which one of them has made."""
    for folder in ("runs", "secrets"):
        (tmp_path / folder).mkdir()
    with Stack(request.param(root, tmp_path), read_compose(root)["services"], tmp_path) as stack:
        assert stack.start("certificates").wait(LIMIT_S) == 0, stack.log("certificates")
        yield stack


def test_the_services_do_a_mission_that_is_recorded_and_shown_and_stop_when_told(stack: Stack, tmp_path: Path) -> None:
    running = {name: stack.start(name) for name in MISSION}
    for name in MISSION:
        assert stack.is_healthy(name), (name, stack.log(name))
    agent = stack.start("agent")
    assert stack.is_healthy("agent"), stack.log("agent")
    assert agent.wait(LIMIT_S) == 0, stack.log("agent")
    report = json.loads((tmp_path / "runs" / "push-seed3" / "report.json").read_text())
    assert (report["success"], report["seed"]) == (True, 3)
    for name in reversed(MISSION):
        running[name].send_signal(signal.SIGTERM)
        assert running[name].wait(LIMIT_S) == 0, (name, stack.log(name))
    assert read_recording([tmp_path / "runs" / "push-seed3.mcap"]).completeness["complete"] == "yes"
    assert "linked with sim.stack.1 as router.stack.1" in stack.log("router")


@pytest.mark.parametrize("stack", PLACES[-1:], indirect=True)
def test_simulators_of_one_service_are_trained_on(stack: Stack, tmp_path: Path) -> None:
    profile = small_profile(steps=32, evaluate_every=32, evaluation_episodes=1)
    (tmp_path / "runs" / "small.toml").write_text(dump_profile(profile))
    stack.start("router")
    for copy in range(2):
        stack.start("train-sim", copy)
    assert all(stack.is_healthy("train-sim", copy) for copy in range(2)), stack.log("train-sim")
    train = stack.start("train")
    assert stack.is_healthy("train"), stack.log("train")
    assert train.wait(LIMIT_S) == 0, stack.log("train")
    assert (tmp_path / "runs" / "train-seed3" / "best" / "policy.safetensors").exists()


@pytest.mark.parametrize("stack", PLACES[-1:], indirect=True)
def test_a_study_is_run_by_the_workers_of_another_service(stack: Stack, tmp_path: Path) -> None:
    studies = tmp_path / "experiments" / "studies"
    studies.mkdir(parents=True)
    (studies / "small.toml").write_text(STUDY_FILE)
    stack.start("router")
    for copy in range(2):
        stack.start("study-worker", copy)
    assert all(stack.is_healthy("study-worker", copy) for copy in range(2)), stack.log("study-worker")
    study = stack.start("study")
    assert study.wait(LIMIT_S) == 0, stack.log("study")
    assert stack.is_healthy("study")
    assert (tmp_path / "runs" / "small" / "cells.parquet").exists()
