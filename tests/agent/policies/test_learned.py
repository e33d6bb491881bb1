"""Trained policies at work, and policy folders that cannot be used."""

import json
import shutil
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from agent_proc.frames.push_view import PushView, box_in_goal_frame, push_view
from agent_proc.learning.training import LAST
from agent_proc.policies.actor import Float32s, Normalizer
from agent_proc.policies.folder import shipped_policies
from agent_proc.policies.learned import NetworkPolicy, load_learned, require_single_face
from agent_proc.policies.registry import make_policy
from agent_proc.policies.world_policy import GuardedPolicy
from agent_proc.task.action import n_actions
from agent_proc.task.file import load_task
from legpush.errors import PolicyError
from legpush.geometry import Pose2
from legpush.scene.scenario import Goal
from tests.agent.fake_world import make_state, scenario_at_station
from tests.agent.learning.small_training import make_training, small_profile
from tests.agent.tasks import tuned

SCENARIO = scenario_at_station()


class Still:
    """A network whose actions are zeros."""

    def __init__(self, n_values: int = 4) -> None:
        self._zeros = np.zeros(n_values, dtype=np.float32)

    def act(self, observation: Float32s) -> Float32s:
        """The same for every observation."""
        return self._zeros


def view_of(box: Pose2) -> PushView:
    return push_view(make_state(SCENARIO.start.pose(), box), SCENARIO)


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a policy."""
    folder = tmp_path_factory.mktemp("training")
    make_training(folder, small_profile(steps=32)).run()
    return folder / LAST


@pytest.fixture
def folder(trained: Path, tmp_path: Path) -> Path:
    """A copy of it to damage."""
    return Path(shutil.copytree(trained, tmp_path / "policy"))


def test_a_policy_decides_the_same_in_the_same_state_and_stops_at_the_goal(folder: Path) -> None:
    policy, again = load_learned(str(folder)), load_learned(str(folder))
    box = SCENARIO.box.pose.pose()
    on_the_way = view_of(box)
    arrived = view_of(SCENARIO.goal.pose.pose())

    push = policy.decide(on_the_way)

    assert push is not None
    assert push == policy.decide(on_the_way) == again.decide(on_the_way)
    assert policy.decide(arrived) is None


@pytest.mark.parametrize(
    ("name", "entry", "n_computed"),
    [("tuned", "fixed", 1), ("tuned", "variable", 1), ("paper-text", "fixed", 0), ("paper-text", "variable", 1)],
)
def test_a_decision_computes_the_box_in_the_frame_of_its_goal_once_if_it_needs_it(
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    entry: Literal["fixed", "variable"],
    n_computed: int,
) -> None:
    task = load_task(name, SCENARIO, entry=entry)
    policy = NetworkPolicy(task, Still(n_actions(task)), None, "untrained")
    n_calls = 0

    def count(box_w: Pose2, goal: Goal) -> Pose2:
        nonlocal n_calls
        n_calls += 1
        return box_in_goal_frame(box_w, goal)

    monkeypatch.setattr("agent_proc.frames.push_view.box_in_goal_frame", count)

    push = policy.decide(view_of(SCENARIO.box.pose.pose()))

    assert push is not None
    assert n_calls == n_computed


def test_mirror_images_get_mirrored_answers(folder: Path) -> None:
    policy = load_learned(str(folder))
    box = SCENARIO.box.pose.pose()
    pushes = [policy.decide(view_of(Pose2(x_m=box.x_m, y_m=box.y_m + dy, yaw_rad=dy))) for dy in (0.05, -0.05)]

    left, right = pushes
    assert left is not None
    assert right is not None
    assert {left.leg, right.leg} == {"FL", "FR"}


def test_a_folder_of_a_training_names_its_policies(folder: Path, tmp_path: Path) -> None:
    training = tmp_path / "training"
    for name in ("best", "last"):
        shutil.copytree(folder, training / name)

    message = rf"{training}: expected a policy, got a folder of policies: choose {training}/best or {training}/last"
    with pytest.raises(PolicyError, match=message):
        load_learned(str(training))


def test_a_folder_of_trainings_names_a_policy_of_one(folder: Path, tmp_path: Path) -> None:
    trainings = tmp_path / "trainings"
    for seed in (2, 1):
        shutil.copytree(folder, trainings / f"seed-{seed}" / "best")

    message = rf"{trainings}: expected a policy, got a folder of trainings: choose one, such as {trainings}/seed-1/best"
    with pytest.raises(PolicyError, match=message):
        load_learned(str(trainings))


@pytest.mark.parametrize("name", ["policy.safetensors", "card.json"])
def test_a_missing_file_is_named(folder: Path, name: str) -> None:
    (folder / name).unlink()

    with pytest.raises(PolicyError, match=rf"policy/{name}: expected this file of a policy"):
        load_learned(str(folder))


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("policy.safetensors", b"other bytes", r"policy\.safetensors: expected weights in the format safetensors"),
        ("card.json", b"[]", r"card\.json: Expected `object`"),
    ],
)
def test_a_corrupt_file_is_named(folder: Path, name: str, data: bytes, message: str) -> None:
    (folder / name).write_bytes(data)

    with pytest.raises(PolicyError, match=message):
        load_learned(str(folder))


def test_networks_that_do_not_fit_the_card_are_refused(folder: Path) -> None:
    card = json.loads((folder / "card.json").read_bytes())
    card["task"]["entry"] = "fixed"
    card["action"].pop()
    (folder / "card.json").write_text(json.dumps(card), encoding="utf-8")

    with pytest.raises(PolicyError, match=r"expected layers\.2\.weight of \(3, 8\) float32.*got \(4, 8\)"):
        load_learned(str(folder))


def test_a_normalizer_of_another_observation_is_refused() -> None:
    two = Normalizer(mean=np.zeros(2), variance=np.ones(2))

    with pytest.raises(PolicyError, match=r"some.pkl: expected 8 means.*observation \(box, .*heading_near\), got 2"):
        NetworkPolicy(tuned(scenario=SCENARIO), Still(), two, "some.pkl")


@pytest.mark.parametrize("name", shipped_policies())
def test_a_shipped_policy_works_and_is_small(name: str) -> None:
    policy = load_learned(name)

    push = policy.decide(view_of(SCENARIO.box.pose.pose()))

    assert push is not None
    assert policy.card.check is not None
    # Pushes that are all 5 cm deep turn the box by 4° each: what is left of that at the end is chance.
    least = {"variable": 0.95, "fixed": 0.6}[policy.card.task.entry]
    assert policy.card.check.success_rate >= least
    assert policy.card.check.position_error_m <= 0.015
    assert policy.card.check.falls == 0


def test_a_policy_that_chooses_the_face_is_none_for_missions() -> None:
    task = load_task("push-l1")
    chooses = NetworkPolicy(task, Still(5), None, "a")
    with pytest.raises(PolicyError, match="whose task has `changes_face = false`"):
        require_single_face(chooses)
    with pytest.raises(PolicyError, match="whose task has `changes_face = false`"):
        require_single_face(GuardedPolicy(chooses, "a"))
    require_single_face(NetworkPolicy(load_task("tuned"), Still(), None, "a"))
    require_single_face(make_policy("scripted"))
