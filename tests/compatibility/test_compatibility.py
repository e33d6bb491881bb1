"""Files that earlier versions made are read as before; `README.md` says how they were made."""

import lzma
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import push_view
from agent_proc.policies.folder import write_policy
from agent_proc.policies.learned import load_learned
from agent_proc.policies.registry import policy_from_data
from agent_proc.programs.policy import read_any_policy
from agent_proc.push_model.map import load_push_map
from agent_proc.reporting.mission_record import read_record
from agent_proc.reporting.phases import phase_report
from legpush.errors import PolicyError
from legpush.history.entries import JOURNAL_VERSION, Opened
from legpush.history.journal import read_entries
from legpush.history.run_history import RunHistory
from legpush.history.steps import PlanRecord, StepRecord, read_episode
from legpush.messages.common import READABLE_VERSIONS
from legpush.messages.stepping import Push, Reset
from legpush.numerics.motion_version import MOTION_VERSION
from legpush.recording.branch import BranchPoint, RecordedPast
from legpush.recording.episodes import read_episodes
from legpush.recording.facts import read_facts, unpack_mission
from legpush.recording.info import lines
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.plans import read_plans
from legpush.scenarios.file import load_scenario
from sim_proc.export.columns import columns_of
from sim_proc.export.source import read_source
from tests.agent.fake_world import make_state, scenario_at_station

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
    assert 6 in READABLE_VERSIONS
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
    today = load_scenario(HERE / "two_pushes.toml")
    then = replace(today.pushing, margin_m=0.05, max_iterations=6000, face_change_m=0.5)
    assert load_scenario(mission.scenario) == replace(today, pushing=then)


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


def test_what_it_did_not_measure_is_told_as_not_known(recording: Recording, folder: Path) -> None:
    """Motions are measured since protocol 8."""
    (episode,) = read_episodes(recording)
    assert [asked.outcome.measures for asked in episode.carried_out() if asked.outcome] == [None] * 3
    source = read_source([folder / "two_pushes.mcap"], None, partial=False)
    columns = {column.name: column.values for column in columns_of(source.episodes)}
    assert np.isfinite(columns["support_margin_m"][1:].astype(np.float64)).all()
    for name in ("zmp_margin_m", "capture_margin_m", "foot_moment_x_w_n_m", "joint_RR_knee_n_m"):
        assert np.isnan(columns[name].astype(np.float64)).all()
    record = read_record(read_episode(folder / "two_pushes.journal"))
    assert phase_report(record.steps, record.scenario.robot) is None


def test_it_can_be_branched_at_a_step(recording: Recording) -> None:
    past = RecordedPast(recording, BranchPoint(0, 2))
    (episode,) = read_episodes(recording)
    for step, asked in enumerate(episode.carried_out()[:2]):
        assert past.act(step, asked.motion, with_trace=True) == asked.outcome
    (record,) = read_plans(recording)
    assert past.plan(record.query) == record.plans[0]


def test_a_fresh_simulator_that_computes_other_bits_is_told_as_another_version(folder: Path) -> None:
    """The recording was made before motions had a version."""
    code = "import sys; from legpush.cli import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, "replay", str(folder / "two_pushes.mcap"), "--verify"],
        capture_output=True,
        text=True,
        check=False,
        timeout=200.0,
    )
    assert done.stderr == ""
    assert done.returncode == 2
    told = f"other version: recorded before motions had a version, here {MOTION_VERSION}; it cannot be verified or "
    assert done.stdout.splitlines()[-1].startswith(told)


def test_a_journal_is_read(folder: Path) -> None:
    path = folder / "two_pushes.journal"
    first = next(iter(read_entries(path)))
    assert isinstance(first, Opened)
    assert (first.journal_version, first.protocol, first.run, first.seed) == (
        JOURNAL_VERSION,
        6,
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


def test_the_policy_of_an_older_version_is_told_from_the_one_that_is_shipped_now(recording: Recording) -> None:
    facts = read_facts(recording)

    with pytest.raises(PolicyError, match=r"policy variable of the recording, .*use the version that made the record"):
        policy_from_data(facts.policy, facts.policy_sha256)


@pytest.mark.parametrize(
    ("name", "push"),
    [
        ("tuned", Push(w1=0.49676634883508086, w2=0.49660930084064603, leg="FL", depth_m=0.03759940192103386)),
        ("sac", Push(w1=0.39552801847457886, w2=0.5313665866851807, leg="FR", depth_m=0.048654361516237254)),
    ],
)
def test_a_policy_folder_of_format_1_is_converted_and_pushes_as_before(name: str, push: Push, tmp_path: Path) -> None:
    write_policy(tmp_path / name, read_any_policy(str(HERE / "policies" / name)))
    scenario = scenario_at_station()

    decided = load_learned(str(tmp_path / name)).decide(
        push_view(make_state(scenario.start.pose(), scenario.box.pose.pose()), scenario)
    )

    assert decided is not None
    assert (decided.leg, decided.face, decided.locus) == (push.leg, push.face, push.locus)
    assert (decided.w1, decided.w2) == pytest.approx((push.w1, push.w2), abs=1e-6)
    assert decided.depth_m == pytest.approx(push.depth_m, abs=1e-7)
