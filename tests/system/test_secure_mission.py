"""Missions over mutual TLS: the same states as over sockets, recorded and viewed, and strangers get nothing."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Final

import pytest

from legpush.bus.secure.host_folder import read_credentials
from legpush.history.run_history import RunHistory
from legpush.recording.mcap_file.reader import read_recording
from legpush.runs.report import read_report
from sim_proc.view.sources import LiveSource
from tests.ports import free_ports
from tests.security.hosts import made
from tests.system.conftest import RecordedMission
from tests.system.missions import LIMIT_S, do_mission, legpush

TOLD_S: Final = 5.0


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test started."""
    with ExitStack() as stack:
        yield stack


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of an authority with two hosts."""
    return made(tmp_path_factory.mktemp("authority") / "lab", "robot", "laptop").parent


@contextmanager
def running(folder: Path, name: str, *words: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a program until the context is left; its output is in `name`.log."""
    with (folder / f"{name}.log").open("wb") as log:
        process = subprocess.Popen([sys.executable, "-P", *words], cwd=folder, stdout=log, stderr=subprocess.STDOUT)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def said(folder: Path, name: str, pattern: str) -> bool:
    """Whether a program wrote this within 5 s."""
    until = monotonic() + TOLD_S
    while re.search(pattern, (folder / f"{name}.log").read_text()) is None:
        if monotonic() > until:
            return False
        sleep(0.05)
    return True


def test_a_launched_mission_over_tls_has_the_states_of_one_over_sockets_and_its_recording_is_complete(
    push_mission: RecordedMission, lab: Path, tmp_path: Path
) -> None:
    flags = ("push", "--no-picture", "--secure", str(lab / "laptop"), "--record", str(tmp_path / "m.mcap"))
    do_mission(tmp_path / "run", *flags)
    report, expected = read_report(tmp_path / "run"), read_report(push_mission.out)
    assert report["state_crc"] == expected["state_crc"]
    assert report["recording"]["complete"] is True
    assert read_recording([tmp_path / "m.mcap"]).completeness["complete"] == "yes"
    for role in ("planner", "sim", "agent", "recorder"):
        log = (tmp_path / "run" / "logs" / f"{role}.log").read_text()
        assert f"taking part as {role}.laptop.1" in log
        assert "WARNING" not in log


def test_processes_by_hand_on_two_hosts_have_the_same_states_while_they_are_recorded(
    push_mission: RecordedMission, lab: Path, tmp_path: Path, stack: ExitStack
) -> None:
    planner, sim, agent = (f"tls/127.0.0.1:{port}" for port in free_ports(3))
    laptop, robot = ("--secure", str(lab / "laptop")), ("--secure", str(lab / "robot"))
    stack.enter_context(running(tmp_path, "planner", "-m", "planner_proc", *laptop, "--listen", planner))
    stack.enter_context(running(tmp_path, "sim", "-m", "sim_proc", *robot, "--listen", sim))
    words = ("-m", "legpush.entry", "legpush.launch.record", "m.mcap", *laptop, "--connect", planner, sim, agent)
    recorder = stack.enter_context(running(tmp_path, "recorder", *words))
    flags = ("--scenario", "push", "--out", "run", "--no-picture", "--recorded", "--listen", agent)
    mission = stack.enter_context(
        running(tmp_path, "agent", "-m", "agent_proc", *laptop, *flags, "--connect", planner, sim)
    )
    viewer = read_credentials(lab / "laptop", "viewer")
    history = RunHistory()
    with LiveSource("local", (planner, sim, agent), viewer) as source:
        while mission.poll() is None:
            source.pump(history, 0.1)
            sleep(0.05)
    assert mission.wait(LIMIT_S) == 0, (tmp_path / "agent.log").read_text()
    assert [len(timeline.steps) > 3 for timeline in history.episodes.values()] == [True]
    assert read_report(tmp_path / "run")["state_crc"] == read_report(push_mission.out)["state_crc"]
    recorder.terminate()
    assert recorder.wait(30.0) in (0, 1)
    topics = {message.topic for message in read_recording([tmp_path / "m.mcap"]).messages}
    assert {"sim/main/action", "sim/main/observation"} <= topics
    assert said(tmp_path, "sim", r"linked with agent\.laptop\.1 as sim\.robot\.1")


def test_an_evaluation_joins_a_simulator_of_another_host(lab: Path, tmp_path: Path, stack: ExitStack) -> None:
    (sim,) = (f"tls/127.0.0.1:{port}" for port in free_ports(1))
    stack.enter_context(running(tmp_path, "sim", "-m", "sim_proc", "--secure", str(lab / "robot"), "--listen", sim))
    words = ("--join", "local", "--simulators", "1", "--episodes", "1", "--out", str(tmp_path / "evaluated"))
    done = legpush("evaluate", "scripted", *words, "--connect", sim, "--secure", str(lab / "laptop"))
    assert done.returncode == 0, done.stderr
    assert said(tmp_path, "sim", r"linked with agent\.laptop\.1 as sim\.robot\.1")


def test_a_stranger_is_told_why_and_the_accepting_side_notes_each_handshake(
    lab: Path, tmp_path: Path, stack: ExitStack
) -> None:
    other = made(tmp_path / "other", "laptop")
    sim, agent = (f"tls/127.0.0.1:{port}" for port in free_ports(2))
    stack.enter_context(running(tmp_path, "sim", "-m", "sim_proc", "--secure", str(lab / "robot"), "--listen", sim))
    assert said(tmp_path, "sim", "taking part as")
    flags = ("--scenario", "push", "--out", "run", "--secure", str(other), "--listen", agent, "--connect", sim)
    began = monotonic()
    refused = stack.enter_context(running(tmp_path, "agent", "-m", "agent_proc", *flags))
    assert refused.wait(LIMIT_S) == 2
    assert monotonic() - began < TOLD_S
    lines = (tmp_path / "agent.log").read_text().splitlines()
    assert [line for line in lines if line.startswith("error: ")] == [
        f"error: {sim}: expected a certificate of the authority of this host, got one that another authority signed "
        f"(unable to get local issuer certificate); this process is agent.laptop.1 of {other}"
    ]
    assert said(tmp_path, "sim", r"zenoh_link_tls.*UnknownCA")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("run", "push", "--secure", "nowhere"), "Expected the folder of a host for --secure"),
        (("run", "push", "--secure", "lab"), "lab/robot), got that of the authority"),
        (
            ("run", "push", "--secure", "lab/laptop", "--planner-command", "true"),
            "Expected either --planner-command or --secure, got both",
        ),
        (("record", "m.mcap", "--secure", "nowhere"), "Expected the folder of a host for --secure"),
        (
            ("record", "m.mcap", "--secure", "lab/laptop", "--connect", "tcp/127.0.0.1:1"),
            "Expected endpoints such as tls/127.0.0.1:17472 with --secure, got 'tcp/127.0.0.1:1'",
        ),
        (("record", "m.mcap", "--connect", "tls/127.0.0.1:1"), "Expected --secure DIR with tls/127.0.0.1:1"),
        (("view", "--secure", "nowhere", "--port", "0"), "Expected the folder of a host for --secure"),
        (("view", "m.mcap", "--secure", "lab/laptop"), "Expected either the files of a recording or a live run"),
        (("evaluate", "scripted", "--secure", "lab/laptop"), "Expected --join RUN with --secure"),
        (("evaluate", "scripted", "--join", "r", "--secure", "nowhere"), "Expected the folder of a host for --secure"),
        (("replay", "m.mcap", "--verify", "--secure", "lab/laptop"), "Expected --secure without --verify and --as"),
    ],
)
def test_bad_input_is_one_error_and_nothing_is_started(
    words: tuple[str, ...], expected: str, lab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab").symlink_to(lab)
    done = legpush(*words)
    line = done.stderr.splitlines()[-1]
    assert (done.returncode, done.stdout, line.startswith("error: ")) == (2, "", True), done.stderr
    assert expected in line
    assert done.stderr.count("error: ") == 1
    assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir() if path.name != "lab"] in ([], ["runs"])


def test_a_recording_that_is_published_over_tls_is_recorded_again(
    push_mission: RecordedMission, lab: Path, tmp_path: Path, stack: ExitStack
) -> None:
    at = f"tls/127.0.0.1:{free_ports(1)[0]}"
    code = "import sys; from legpush.cli import main; sys.exit(main())"
    robot, laptop = str(lab / "robot"), str(lab / "laptop")
    words = ("-c", code, "record", "again.mcap", "--run", "replay", "--connect", at, "--secure", laptop, "--json")
    recorder = stack.enter_context(running(tmp_path, "recorder", *words))
    assert said(tmp_path, "recorder", "recording to")
    published = legpush("replay", str(push_mission.file), "--rate", "3", "--listen", at, "--secure", robot)
    assert published.returncode == 0, published.stderr
    assert f"--connect {at} --secure {robot}`" in published.stdout
    recorder.terminate()
    recorder.wait(30.0)
    text = (tmp_path / "recorder.log").read_text()
    assert json.loads(text[text.index("\n{\n") :])["n_recorded"] > 0
