"""Files that earlier versions made are read as before; `README.md` says how they were made."""

import lzma
import platform
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import msgspec
import pytest

from agent_proc.push_model.map import load_push_map
from legpush.history.journal import JOURNAL_VERSION, Opened, read_entries
from legpush.history.run_history import RunHistory
from legpush.history.steps import PlanRecord, StepRecord, read_episode
from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.stepping import Push, Reset
from legpush.recording.branch import BranchPoint, RecordedPast
from legpush.recording.episodes import read_episodes
from legpush.recording.facts import unpack_mission
from legpush.recording.info import lines
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.plans import read_plans
from legpush.scenarios.file import load_scenario

HERE = Path(__file__).parent
LAST_CRC = 0x9EA5FE70
"""Of the state after the second push."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files, unpacked."""
    folder = tmp_path_factory.mktemp("compatibility")
    for packed in HERE.glob("*.xz"):
        (folder / packed.stem).write_bytes(lzma.decompress(packed.read_bytes()))
    return folder


@pytest.fixture(scope="module")
def recording(folder: Path) -> Recording:
    return read_recording([folder / "two_pushes.mcap"])


def test_a_recording_is_read_with_everything_that_is_told_of_it(recording: Recording) -> None:
    assert recording.is_complete
    told = "\n".join(lines(recording))
    for words in (
        "run two_pushes, protocol 6",
        "complete      yes",
        "result        max_push_cycles: box error 0.882 m, 0.8° after 2 push cycles",
        "steps 0 to 2, 5.5 s simulated, state 9ea5fe70",
        "agent/main/scenario.toml",
        "sim/main/model.xml",
    ):
        assert words in told


def test_its_mission_can_be_run_again(recording: Recording, tmp_path: Path) -> None:
    mission = unpack_mission(recording, tmp_path)
    assert (mission.facts.seed, mission.facts.policy, mission.push_map) == (1, "variable", None)
    assert load_scenario(mission.scenario) == load_scenario(HERE / "two_pushes.toml")


def test_its_history_has_the_episode_its_plan_and_what_the_processes_said(recording: Recording) -> None:
    history = RunHistory()
    for message in recording.messages:
        history.take_message(message.topic, message.origin, message.copy)
    (timeline,) = history.episodes.values()
    assert history.n_unreadable == 0
    assert [type(step.motion) for step in timeline.steps] == [Reset, Push, Push]
    assert timeline.n_rows == timeline.steps[-1].world.tick + 1
    assert [planned.plan.status for _, planned in history.plans_of(timeline)] == ["exact"]
    assert {said.origin.role for said in history.said} == {"planner", "sim", "agent"}
    assert timeline.rewards.keys() == {1, 2}


def test_it_can_be_branched_at_a_step(recording: Recording) -> None:
    past = RecordedPast(recording, BranchPoint(0, 2))
    (episode,) = read_episodes(recording)
    for step, asked in enumerate(episode.carried_out()[:2]):
        assert past.act(step, asked.motion, with_trace=True) == asked.outcome
    (record,) = read_plans(recording)
    assert past.plan(record.query) == record.plans[0]


def test_a_fresh_simulator_answers_what_was_recorded(recording: Recording, folder: Path) -> None:
    noted = recording.attachment("versions.json")
    assert noted is not None
    recorded = msgspec.json.decode(noted.data, type=dict[str, str])["mujoco"]
    if (recorded, "x86_64") != (version("mujoco"), platform.machine()):
        pytest.skip(f"recorded with MuJoCo {recorded} on x86_64: other bits are no surprise here")
    code = "import sys; from legpush.cli import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, "replay", str(folder / "two_pushes.mcap"), "--verify"],
        capture_output=True,
        text=True,
        check=False,
        timeout=200.0,
    )
    assert "identical: 3 steps, 5.5 s simulated" in done.stdout, done.stdout + done.stderr
    assert done.returncode == 0


def test_a_journal_is_read(folder: Path) -> None:
    path = folder / "two_pushes.journal"
    first = next(iter(read_entries(path)))
    assert isinstance(first, Opened)
    assert (first.journal_version, first.protocol, first.run, first.seed) == (
        JOURNAL_VERSION,
        PROTOCOL_VERSION,
        "two_pushes",
        1,
    )
    records = list(read_episode(path))
    steps = [record for record in records if isinstance(record, StepRecord)]
    plans = [record for record in records if isinstance(record, PlanRecord)]
    assert [type(step.motion) for step in steps] == [Reset, Push, Push]
    assert steps[-1].outcome.state_crc == LAST_CRC
    assert [record.plan.status for record in plans] == ["exact"]


def test_journal_and_recording_have_the_same_outcomes(recording: Recording, folder: Path) -> None:
    (episode,) = read_episodes(recording)
    journal = [
        record.outcome for record in read_episode(folder / "two_pushes.journal") if isinstance(record, StepRecord)
    ]
    assert [asked.outcome for asked in episode.carried_out()] == journal


def test_a_push_map_is_loaded() -> None:
    push_map = load_push_map(HERE / "push_map.json", load_scenario("default").box)
    assert len(push_map.effects) == 4
    assert {circle.radius_m.kind for circle in push_map.circles} == {"percentile bootstrap 95 %"}
