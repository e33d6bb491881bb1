"""The branch of a recorded mission: what is decided as it was recorded, and what is not."""

from pathlib import Path

import msgspec
import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.mission.branching import Branch, BranchPolicy, read_branch
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.errors import PolicyError, RecordingError
from legpush.messages.stepping import Alter, Push
from legpush.messages.telemetry import Fact
from legpush.recording.branch import BranchPoint
from legpush.recording.facts import MISSION_FILE, MissionFacts
from legpush.scene.names import PlannerName
from tests.agent.fake_world import make_scenario, make_state
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import traffic, write

AT = BranchPoint(episode=0, step=8)


def recorded(tmp_path: Path, policy_sha256: str = "") -> tuple[Path, ...]:
    """The files of a recorded mission of the scripted policy, which is code alone."""
    facts = MissionFacts(seed=3, policy="scripted", policy_sha256=policy_sha256)
    fact = Fact(name=MISSION_FILE, media_type="application/json", data=msgspec.json.encode(facts))
    return tuple(write(tmp_path / "a.mcap", *traffic(mission()), facts=(fact,)))


def branch(tmp_path: Path, planner: PlannerName | None = None) -> Branch:
    return read_branch(recorded(tmp_path), AT, planner=planner, alter=None)


def test_the_steps_before_the_branch_point_are_the_past(tmp_path: Path) -> None:
    read = branch(tmp_path)

    assert [read.is_past(n_steps) for n_steps in (0, 7, 8, 9)] == [True, True, False, False]
    assert isinstance(read.past_policy, ScriptedPolicy)


def test_the_box_is_altered_as_it_was_asked_for(tmp_path: Path) -> None:
    alter = Alter(box_mass_kg=3.0)

    assert read_branch(recorded(tmp_path), AT, planner=None, alter=alter).past.alter == alter


def test_another_planner_is_asked_from_the_branch_point_on(tmp_path: Path) -> None:
    scenario = make_scenario()
    assert scenario.planning.planner != "rrt_star"
    read = branch(tmp_path, planner="rrt_star")

    assert read.scenario(scenario, 7) == scenario
    assert read.scenario(scenario, 8).planning.planner == "rrt_star"
    assert replace(read.scenario(scenario, 8), planning=scenario.planning) == scenario


def test_without_another_planner_the_scenario_stays(tmp_path: Path) -> None:
    scenario = make_scenario()

    assert branch(tmp_path).scenario(scenario, 8) is scenario


def test_a_policy_that_has_changed_since_the_recording_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        PolicyError, match=r"Expected the policy scripted of the recording, SHA-256 0123456789abcdef\.\.\., got one"
    ):
        read_branch(recorded(tmp_path, "0123456789abcdef0123"), AT, planner=None, alter=None)


def test_a_recording_of_something_else_is_refused(tmp_path: Path) -> None:
    files = tuple(write(tmp_path / "a.mcap", *traffic(mission())))

    with pytest.raises(RecordingError, match="Expected the recording of a mission"):
        read_branch(files, AT, planner=None, alter=None)


class Always:
    """A policy that always pushes equally deep."""

    def __init__(self, depth_m: float) -> None:
        self._depth_m = depth_m

    def decide(self, _view: PushView) -> Push | None:
        return Push(w1=0.5, w2=0.5, leg="FL", depth_m=self._depth_m)


def test_the_policy_of_the_recording_decides_in_the_past_and_the_other_one_after_it() -> None:
    past = [True, True, False]
    policy = BranchPolicy(Always(0.02), Always(0.05), lambda: past.pop(0))
    scenario = make_scenario()
    view = push_view(make_state(scenario.start.pose(), scenario.box.pose.pose()), scenario)

    pushes = [policy.decide(view) for _ in range(3)]

    assert [push.depth_m for push in pushes if push is not None] == [0.02, 0.02, 0.05]
