"""The command lines of the processes of a mission."""

import stat
import sys
from pathlib import Path

import msgspec
import pytest

from legpush.fields import Name
from legpush.launch.process_commands import Place, bus_flags, process_arguments, recorded_policy_flags
from legpush.options.run import RunOptions
from legpush.policy_names import DEFAULT_POLICY
from legpush.recording.facts import MissionFacts


@pytest.mark.parametrize("folder", ["run-1", "my run.5 (ü)", "x" * 100])
def test_the_run_is_named_after_its_folder(folder: str, tmp_path: Path) -> None:
    run = Place(folder=tmp_path / folder, sockets=tmp_path).run
    assert msgspec.convert(run, Name) == run
    assert run == Place(folder=tmp_path / folder, sockets=tmp_path / "other").run


def test_only_the_agent_gets_the_scenario(tmp_path: Path) -> None:
    place = Place(folder=tmp_path, sockets=tmp_path)
    options = RunOptions(seed=5)
    assert process_arguments("sim", options, place) == (sys.executable, "-P", "-m", "sim_proc")
    agent = " ".join(process_arguments("agent", options, place))
    assert f"--scenario {tmp_path}/scenario.toml --seed 5 --out {tmp_path} --policy {DEFAULT_POLICY}" in agent


def test_processes_meet_at_sockets_in_a_private_directory(tmp_path: Path) -> None:
    sockets = tmp_path / "s"
    sockets.mkdir(mode=0o700)
    place = Place(folder=tmp_path / "run-1", sockets=sockets)
    sim = bus_flags("sim", RunOptions(), place)
    agent = bus_flags("agent", RunOptions(seed=3, inject_faults=0.2), place)
    listens = sim[sim.index("--listen") + 1]
    assert sim == ("--run", "run-1", "--listen", listens)
    assert listens in agent[agent.index("--connect") :]
    assert agent[-4:] == ("--inject-faults", "0.2", "--fault-seed", "3")
    assert stat.S_IMODE(sockets.stat().st_mode) == 0o700


def test_only_the_agent_is_told_to_trust_a_model_file(tmp_path: Path) -> None:
    place, options = Place(folder=tmp_path, sockets=tmp_path), RunOptions(policy="a.zip", trust_policy_file=True)
    assert "--trust-policy-file" in process_arguments("agent", options, place)
    assert "--trust-policy-file" not in process_arguments("agent", RunOptions(), place)
    assert "--trust-policy-file" not in process_arguments("sim", options, place)


def test_the_agent_gets_the_recorded_hash_unless_the_user_wants_another_policy() -> None:
    facts = MissionFacts(seed=0, policy="own:make", policy_sha256="12ab")
    sha256, repeated = ("--recorded-policy-sha256", "12ab"), ("--repeated-policy", "own:make")
    assert recorded_policy_flags(facts, None, None) == sha256
    assert recorded_policy_flags(facts, "own:make", "own:make") == sha256 + repeated
    assert recorded_policy_flags(facts, "scripted", "own:make") == repeated
