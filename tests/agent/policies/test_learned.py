"""Trained policies at work, and policy folders that cannot be used."""

import json
import shutil
from pathlib import Path
from typing import Literal

import pytest
from stable_baselines3.common.utils import ConstantSchedule
from stable_baselines3.ppo import MlpPolicy as PpoPolicy

from agent_proc.frames.push_view import PushView, box_in_goal_frame, push_view
from agent_proc.learning.training import LAST
from agent_proc.policies.folder import shipped_policies
from agent_proc.policies.learned import NetworkPolicy, load_learned
from agent_proc.task.action import action_space
from agent_proc.task.config import TaskConfig
from agent_proc.task.observation import observation_space
from legpush.errors import PolicyError
from legpush.geometry import Pose2
from legpush.scene.scenario import Goal
from tests.agent.fake_world import make_state, scenario_at_station
from tests.agent.learning.small_training import make_training, small_profile

SCENARIO = scenario_at_station()


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
    ("profile", "entry", "n_computed"),
    [("relative", "fixed", 1), ("relative", "variable", 1), ("paper", "fixed", 0), ("paper", "variable", 1)],
)
def test_a_decision_computes_the_box_in_the_frame_of_its_goal_once_if_it_needs_it(
    monkeypatch: pytest.MonkeyPatch,
    profile: Literal["relative", "paper"],
    entry: Literal["fixed", "variable"],
    n_computed: int,
) -> None:
    task = TaskConfig(
        entry=entry, observation=profile, reward="paper" if profile == "paper" else "tuned", scenario=SCENARIO
    )
    networks = PpoPolicy(observation_space(task), action_space(task), ConstantSchedule(0.0))
    policy = NetworkPolicy(task, networks, None, "untrained")
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


@pytest.mark.parametrize("name", ["policy.zip", "normalizer.json", "card.json"])
def test_a_missing_file_is_named(folder: Path, name: str) -> None:
    (folder / name).unlink()

    with pytest.raises(PolicyError, match=rf"policy/{name}: expected this file of a policy"):
        load_learned(str(folder))


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("policy.zip", b"no zip", r"policy\.zip: expected a policy of Stable-Baselines3 \(a zip\)"),
        ("normalizer.json", b"{", r"normalizer\.json: "),
        ("normalizer.json", b'{"mean": [1.0], "variance": [1.0]}', r"expected 8 means.*observation `relative`, got 1"),
        ("normalizer.json", b'{"mean": [1.0], "variance": []}', "expected as many variances as means, got 0 and 1"),
        ("card.json", b"[]", r"card\.json: Expected `object`"),
    ],
)
def test_a_corrupt_file_is_named(folder: Path, name: str, data: bytes, message: str) -> None:
    (folder / name).write_bytes(data)

    with pytest.raises(PolicyError, match=message):
        load_learned(str(folder))


def test_half_a_zip_is_refused(folder: Path) -> None:
    data = (folder / "policy.zip").read_bytes()
    (folder / "policy.zip").write_bytes(data[: len(data) // 2])

    with pytest.raises(PolicyError, match=r"policy\.zip: expected (a policy of Stable-Baselines3|weights named)"):
        load_learned(str(folder))


def test_networks_that_do_not_fit_the_spaces_of_the_card_are_refused(folder: Path) -> None:
    card = json.loads((folder / "card.json").read_bytes())
    card["task"]["entry"] = "fixed"
    (folder / "card.json").write_text(json.dumps(card), encoding="utf-8")

    with pytest.raises(PolicyError, match=r"policy\.zip: expected networks \(8, 8\) for 8 observations.*size mismatch"):
        load_learned(str(folder))


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
