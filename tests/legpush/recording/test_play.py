"""A recording in the place of a simulator or a planner: what was answered, and nothing else."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.bus import keys
from legpush.errors import MotionError, OtherVersionError, RecordingError
from legpush.messages import codec
from legpush.messages.planning import PlanRequest, PlanResult
from legpush.messages.stepping import Motion, Push, Walk
from legpush.messages.telemetry import Copies
from legpush.numerics.computed_with import ComputedWith
from legpush.numerics.current import current
from legpush.numerics.motion_version import MOTION_VERSION
from legpush.plans.planner import PlanningInterruptedError
from legpush.recording.episodes import read_episodes
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import RecordingFile
from legpush.recording.plans import read_plans
from legpush.recording.play import RecordedPlanner, RecordedSim
from legpush.recording.recorder import Recorder, Wanted
from tests.legpush.examples import QUERY
from tests.legpush.fakes import RUN, FakeStepper, fake_plan, mission
from tests.legpush.recording.recordings import ABOUT, AGENT, a_recording, batch, copy, header

PLANNER = replace(AGENT, role="planner", incarnation="planner-1")
HERE = ComputedWith(str(MOTION_VERSION), current().name)
OTHER = Push(w1=0.5, w2=0.123, leg="FL", depth_m=0.1)


def sim_of(tmp_path: Path, motions: list[Motion] | None = None) -> RecordedSim:
    return RecordedSim(read_episodes(read_recording([a_recording(tmp_path / "a.mcap", motions)])), HERE)


def test_a_recorded_simulator_gives_the_recorded_answers_with_trace_or_without(tmp_path: Path) -> None:
    recorded, fake = sim_of(tmp_path), FakeStepper()
    for with_trace in (True, False):
        for motion in mission():
            assert recorded.perform(motion, with_trace=with_trace) == fake.perform(motion, with_trace=with_trace)


def test_a_recorded_simulator_refuses_what_was_refused_and_goes_on(tmp_path: Path) -> None:
    motions = mission()
    recorded = sim_of(tmp_path, [motions[0], Walk(), *motions[1:]])
    recorded.perform(motions[0], with_trace=True)
    with pytest.raises(MotionError, match="Expected a follow before the first walk"):
        recorded.perform(Walk(), with_trace=True)
    assert recorded.perform(motions[1], with_trace=True).state_crc


@pytest.mark.parametrize(
    ("at", "motion", "words"),
    [
        (6, OTHER, r"step 6: expected push with w2 0.1 as recorded, got 0.123"),
        (6, Walk(), "step 6: expected push as recorded, got walk"),
        (24, Walk(), "step 24: the recording ends before it, got walk"),
    ],
)
def test_what_was_not_recorded_is_named(tmp_path: Path, at: int, motion: Motion, words: str) -> None:
    recorded = sim_of(tmp_path)
    for each in mission()[:at]:
        recorded.perform(each, with_trace=True)
    with pytest.raises(RecordingError, match=words):
        recorded.perform(motion, with_trace=True)


def planned(path: Path, n: int = 2) -> Recording:
    """A recording of two queries, the second one answered twice."""
    requests = [PlanRequest(header=header(AGENT, i), request_id=i, query=replace(QUERY, seed=i)) for i in range(n)]
    results = [
        PlanResult(
            header=header(PLANNER, i),
            client_incarnation=AGENT.incarnation,
            request_id=min(i, n - 1),
            revision=max(0, i - n + 1),
            final=True,
            plan=replace(fake_plan(replace(QUERY, seed=min(i, n - 1))), n_iterations=i),
        )
        for i in range(n + 1)
    ]
    file = RecordingFile(path, ABOUT)
    recorder = Recorder(file, Wanted())
    asked = [copy(keys.plan_request(RUN, "main"), i, codec.encode(each)) for i, each in enumerate(requests)]
    told = [copy(keys.plan_result(RUN, "main"), i, codec.encode(each)) for i, each in enumerate(results)]
    batches: list[Copies] = [batch(AGENT, 0, asked, final=True), batch(PLANNER, 0, told, final=True)]
    for each in batches:
        recorder.write_batch(each)
    file.finish({})
    return read_recording([path])


def test_a_recorded_planner_gives_the_recorded_revisions_and_then_waits(tmp_path: Path) -> None:
    player = RecordedPlanner(read_plans(planned(tmp_path / "a.mcap")), HERE)
    plans = player.make_plans(replace(QUERY, seed=1), lambda: True)
    assert [next(plans).n_iterations, next(plans).n_iterations] == [1, 2]
    with pytest.raises(PlanningInterruptedError):
        next(plans)
    with pytest.raises(RecordingError, match="no such query; it differs from the last one of its kind in seed: 1, 77"):
        next(player.make_plans(replace(QUERY, seed=77), lambda: True))


def test_what_another_version_did_not_record_is_told_as_that(tmp_path: Path) -> None:
    recording = read_recording([a_recording(tmp_path / "a.mcap")])
    simulator = RecordedSim(read_episodes(recording), ComputedWith("1"))
    simulator.perform(mission()[0], with_trace=False)
    with pytest.raises(OtherVersionError, match=r"^other version: recorded with motion version 1, here \d+; it cannot"):
        simulator.perform(OTHER, with_trace=False)
    planner = RecordedPlanner(read_plans(planned(tmp_path / "b.mcap")), ComputedWith())
    with pytest.raises(OtherVersionError, match=r"^other version: recorded before motions had a version, here "):
        next(planner.make_plans(replace(QUERY, seed=77), lambda: True))
