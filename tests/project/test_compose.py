"""`compose.yaml` follows the compose specification, and its services, run as local processes, do a mission."""

import json
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.ports import free_ports

VARIABLES = {"SCENARIO": "push", "SEED": "3"}
"""What a user sets: the shortest mission."""
MISSION_LIMIT_S = 240.0
STOP_LIMIT_S = 30.0

Service = dict[str, Any]


@pytest.fixture(scope="module")
def services(root: Path) -> dict[str, Service]:
    """The services, with variables replaced as compose does."""
    text = re.sub(
        r"\$\{(\w+):-([^}]*)\}",
        lambda match: VARIABLES.get(match[1], match[2]),
        (root / "compose.yaml").read_text(),
    )
    assert "${" not in text
    found: dict[str, Service] = yaml.safe_load(text)["services"]
    return found


@pytest.fixture
def commands(services: dict[str, Service], tmp_path: Path) -> dict[str, list[str]]:
    """Each service's command for this machine: own interpreter, free ports of 127.0.0.1, volumes in `tmp_path`."""
    ports = {port for _, port in re.findall(r"tcp/([\w.]+):(\d+)", str(services))}
    free = dict(zip(sorted(ports), free_ports(len(ports)), strict=True))

    def here(word: str, service: Service) -> str:
        word = re.sub(r"tcp/[\w.]+:(\d+)", lambda match: f"tcp/127.0.0.1:{free[match[1]]}", word)
        for volume in service.get("volumes", ()):
            if Path(word).is_relative_to(volume["target"]):
                word = str(tmp_path / volume["source"] / Path(word).relative_to(volume["target"]))
        return word

    started = {name: [here(word, service) for word in service["command"]] for name, service in services.items()}
    assert {command[0] for command in started.values()} == {"python"}
    return {name: [sys.executable, *command[1:]] for name, command in started.items()}


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test started."""
    with ExitStack() as stack:
        yield stack


def check(path: Path) -> subprocess.CompletedProcess[str]:
    """Check a file against the published schema of the compose specification, which the checker carries."""
    checker = Path(sys.executable).with_name("check-jsonschema")
    command = [str(checker), "--builtin-schema", "vendor.compose-spec", str(path)]
    return subprocess.run(command, check=False, capture_output=True, text=True)


def start(stack: ExitStack, command: list[str], folder: Path) -> subprocess.Popen[bytes]:
    """Start a process that does not outlive the test; its output is shown if the test fails."""
    process = subprocess.Popen(command, cwd=folder)

    def end() -> None:
        process.kill()
        process.wait()

    stack.callback(end)
    return process


def test_the_file_follows_the_compose_specification(root: Path) -> None:
    assert check(root / "compose.yaml").returncode == 0


def test_a_mistyped_field_would_be_noticed(root: Path, tmp_path: Path) -> None:
    broken = tmp_path / "compose.yaml"
    broken.write_text((root / "compose.yaml").read_text().replace("stop_signal:", "stop_sginal:"))
    assert "stop_sginal" in check(broken).stdout


def test_there_is_one_service_for_each_process_and_all_run_one_image(services: dict[str, Service]) -> None:
    assert services.keys() == {"planner", "sim", "agent"}
    assert {(service["image"], service["build"]) for service in services.values()} == {("legpush", ".")}
    assert [service["command"][2] for service in services.values()] == [f"{name}_proc" for name in services]


def test_whoever_is_connected_to_listens_there(services: dict[str, Service]) -> None:
    listening, connecting = set(), set()
    for name, service in services.items():
        for host, port in re.findall(r"tcp/([\w.]+):(\d+)", str(service["command"])):
            if host == "0.0.0.0":
                listening.add((name, port))
            else:
                connecting.add((host, port))
    assert connecting == listening != set()


def test_nothing_is_reachable_from_outside(root: Path, services: dict[str, Service]) -> None:
    networks = yaml.safe_load((root / "compose.yaml").read_text())["networks"]
    assert all(network["internal"] for network in networks.values())
    assert all(service["networks"] == list(networks) and "ports" not in service for service in services.values())


def test_the_services_do_a_mission_and_stop_when_told(
    services: dict[str, Service], commands: dict[str, list[str]], stack: ExitStack, tmp_path: Path
) -> None:
    (tmp_path / "runs").mkdir()
    running = {name: start(stack, command, tmp_path) for name, command in commands.items()}
    assert running["agent"].wait(MISSION_LIMIT_S) == 0
    report = json.loads((tmp_path / "runs" / "push-seed3" / "report.json").read_text())
    assert (report["success"], report["seed"]) == (True, 3)
    for name in ("planner", "sim"):
        running[name].send_signal(signal.Signals[services[name]["stop_signal"]])
        assert running[name].wait(STOP_LIMIT_S) == 0, name
