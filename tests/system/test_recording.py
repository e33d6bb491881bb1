"""A recorder process beside a fake run: everything is there, byte for byte, and whatever happens to the recorder, the
lockstep goes on.
"""

import json
import random
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, time_ns
from typing import Any

import pytest
import zenoh
from msgspec.structs import replace

from legpush.bus import keys
from legpush.bus.endpoints import in_directory
from legpush.messages.stepping import Walk
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.recover import recover
from tests.legpush.examples import QUERY
from tests.legpush.fakes import IMPATIENT, RUN, Agent, agent, bus, crc_after, eventually, mission, planner, sim
from tests.system.missions import LEGPUSH, legpush


@contextmanager
def recorder(directory: Path, file: Path, *flags: str) -> Iterator[subprocess.Popen[str]]:
    """A recorder process of the fake run, which is there."""
    command = [*LEGPUSH, "record", str(file), "--run", RUN, "--connect"]
    command += [*in_directory(directory, "recorder").connect, *flags]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGCONT)
            process.kill()
        process.communicate()


@contextmanager
def witness(directory: Path) -> Iterator[tuple[zenoh.Session, dict[tuple[str, bytes], int]]]:
    """Counts everything that the fake run puts on its lockstep and status keys, as Zenoh itself delivers it."""
    seen: dict[tuple[str, bytes], int] = {}
    config = zenoh.Config()
    settings: dict[str, Any] = {
        "mode": "peer",
        "listen/endpoints": [],
        "connect/endpoints": list(in_directory(directory, "launcher").connect),
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "connect/retry": {"period_init_ms": 50, "period_max_ms": 200, "period_increase_factor": 1.5},
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "open/return_conditions/connect_scouted": False,
    }
    for path, value in settings.items():
        config.insert_json5(path, json.dumps(value))

    def take(sample: zenoh.Sample) -> None:
        key, payload = str(sample.key_expr), sample.payload.to_bytes()
        if not key.endswith(("/copies", "/taken")):
            seen[key, payload] = seen.get((key, payload), 0) + 1

    with zenoh.open(config) as session:
        session.declare_subscriber(f"{keys.prefix(RUN)}/**", zenoh.handlers.Callback(take, indirect=True))
        yield session, seen


def walk(asking: Agent, n: int) -> float:
    """Steps per second."""
    began = monotonic()
    asking.do([Walk()] * n)
    return n / (monotonic() - began)


def contents(recording: Recording) -> dict[tuple[str, bytes], int]:
    return {(message.copy.key, message.copy.payload): 1 for message in recording.messages}


def test_a_recording_has_every_message_byte_for_byte(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    with recorder(tmp_path, file) as process:
        with witness(tmp_path) as (session, seen), sim(tmp_path), planner(tmp_path), agent(tmp_path) as asking:
            assert eventually(lambda: len(asking.bus.liveliness.live("recorder")) == 1, 20.0)
            assert eventually(lambda: len(asking.bus.liveliness.live("planner")) == 1)
            assert eventually(lambda: len(list(session.info.peers_zid())) == 3)
            asking.do(mission())
            walk(asking, 500)
            n_sent = 2 * (len(mission()) + 500)
            assert eventually(lambda: sum("/sim/" in key and "/tap/" not in key for key, _ in seen) >= n_sent)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30.0)
    assert process.returncode == 0, out + err
    recording = read_recording([file])
    recorded = contents(recording)
    lockstep = {key: n for key, n in seen.items() if "/tap/" not in key[0]}
    assert len(lockstep) >= n_sent
    assert lockstep.items() <= recorded.items()
    assert recording.completeness["n_missing"] == "0", out
    assert len(recorded) == len(recording.messages) == int(recording.completeness["n_recorded"])


@pytest.mark.parametrize("seed", [1, 2])
def test_a_recorder_that_is_killed_loses_at_most_a_second(tmp_path: Path, seed: int) -> None:
    file, out = tmp_path / "a.mcap", tmp_path / "b.mcap"
    life_s = random.Random(seed).uniform(1.2, 3.0)
    with sim(tmp_path), agent(tmp_path) as asking, recorder(tmp_path, file) as process:
        assert eventually(lambda: len(asking.bus.liveliness.live("recorder")) == 1, 20.0)
        asking.do(mission())
        until = monotonic() + life_s
        while monotonic() < until:
            walk(asking, 20)
        killed_ns = time_ns()
        process.kill()
        process.wait()
        walk(asking, 20)
    before = file.read_bytes()
    recover(file, out)
    assert file.read_bytes() == before
    recording = read_recording([out])
    actions = [message.copy for message in recording.messages if message.topic == "sim/main/action"]
    sequences = [copy.sequence for copy in actions]
    assert sequences == list(range(sequences[0], sequences[0] + len(sequences)))
    assert killed_ns - actions[-1].time_ns < 1e9
    assert legpush("info", str(file)).returncode == 2
    assert legpush("info", str(out)).returncode == 0


def test_a_recorder_that_is_frozen_stalls_nobody_and_says_what_it_lacks(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    with recorder(tmp_path, file) as process:
        with sim(tmp_path), agent(tmp_path) as asking:
            assert eventually(lambda: len(asking.bus.liveliness.live("recorder")) == 1, 20.0)
            asking.do(mission())
            usual = walk(asking, 1500)
            process.send_signal(signal.SIGSTOP)
            slowest_s, n_frozen, until = 0.0, 0, monotonic() + 6.0
            while monotonic() < until:
                began = monotonic()
                walk(asking, 1)
                slowest_s, n_frozen = max(slowest_s, monotonic() - began), n_frozen + 1
            process.send_signal(signal.SIGCONT)
            assert eventually(lambda: len(asking.bus.liveliness.live("recorder")) == 1, 20.0)
            walk(asking, 100)
            n_steps = len(asking.past)
            assert asking.past[-1].state_crc == crc_after([*mission(), *[Walk()] * (n_steps - len(mission()))])
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30.0)
    assert n_frozen / 6.0 > 0.3 * usual
    assert slowest_s < 1.0
    recording = read_recording([file])
    n_actions = sum(message.topic == "sim/main/action" for message in recording.messages)
    assert recording.completeness["n_missing"] == "0", out + err
    assert n_actions >= n_steps


def test_a_recorder_that_is_stuck_does_not_keep_another_one_from_its_messages(tmp_path: Path) -> None:
    """Its token stays up, as where the disk does not answer: it is there, and takes nothing."""
    file = tmp_path / "a.mcap"
    with recorder(tmp_path, file) as process:
        with bus(tmp_path, "recorder", "stuck") as stuck, sim(tmp_path), agent(tmp_path) as asking:
            stuck.announce()
            assert eventually(lambda: len(asking.bus.liveliness.live("recorder")) == 2, 20.0)
            asking.do(mission())
            until = monotonic() + 6.0
            while monotonic() < until:
                walk(asking, 20)
            assert len(asking.bus.liveliness.live("recorder")) == 2
            left_bytes = asking.bus.taps.own.buffer.n_bytes
            n_steps = len(asking.past)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30.0)
    assert process.returncode == 0, out + err
    recording = read_recording([file])
    assert sum(message.topic == "sim/main/action" for message in recording.messages) >= n_steps
    assert left_bytes < 100_000


def test_what_an_agent_hears_stands_in_for_a_planner_that_hands_over_nothing(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    with recorder(tmp_path, file) as process:
        with planner(tmp_path) as silent, bus(tmp_path, "agent") as opened:
            silent.taps.own.close()
            opened.taps.witness_role("planner")
            asking = Agent(opened, IMPATIENT)
            assert eventually(lambda: len(opened.liveliness.live("recorder")) == 1, 20.0)
            for seed in range(5):
                asking.planner.plan(replace(QUERY, seed=seed))
            process.send_signal(signal.SIGINT)
            assert eventually(opened.taps.own.buffer.is_empty)
        out, err = process.communicate(timeout=30.0)
    assert process.returncode == 0, out + err
    results = [message for message in read_recording([file]).messages if message.topic == "plan/main/result"]
    assert [message.copy.sequence for message in results] == list(range(5))
    assert {message.origin.role for message in results} == {"planner"}
