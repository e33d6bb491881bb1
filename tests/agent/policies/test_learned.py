"""Trained policies at work, and policy folders that cannot be used."""

import json
import shutil
import sys
from pathlib import Path

import pytest

from agent_proc.learning.training import LAST
from agent_proc.policies.folder import shipped_policies
from agent_proc.policies.learned import load_learned
from agent_proc.policies.registry import make_policy
from legpush.errors import PolicyError
from legpush.geometry import Pose2
from tests.agent.fake_world import make_state, scenario_at_station
from tests.agent.learning.small_training import make_training, small_profile

SCENARIO = scenario_at_station()


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
    on_the_way = make_state(SCENARIO.start.pose(), box)
    arrived = make_state(SCENARIO.start.pose(), SCENARIO.goal.pose.pose())

    push = policy.decide(on_the_way, SCENARIO)

    assert push is not None
    assert push == policy.decide(on_the_way, SCENARIO) == again.decide(on_the_way, SCENARIO)
    assert policy.decide(arrived, SCENARIO) is None


def test_mirror_images_get_mirrored_answers(folder: Path) -> None:
    policy = load_learned(str(folder))
    box, start = SCENARIO.box.pose.pose(), SCENARIO.start.pose()
    pushes = [
        policy.decide(make_state(start, Pose2(x_m=box.x_m, y_m=box.y_m + dy, yaw_rad=dy)), SCENARIO)
        for dy in (0.05, -0.05)
    ]

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


def test_an_unknown_policy_is_refused_with_the_valid_names() -> None:
    with pytest.raises(PolicyError, match=r"Expected a policy \(scripted.*\) or the folder of one, got 'nobody'"):
        make_policy("nobody")


def test_a_policy_of_ones_own_comes_from_an_entry_point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "my_push_policy.py").write_text(
        "class Stop:\n    def decide(self, world, scenario):\n        return None\n\nmake = Stop\nwrong = dict\n",
        encoding="utf-8",
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])

    policy = make_policy("my_push_policy:make")

    assert policy.decide(make_state(SCENARIO.start.pose(), SCENARIO.box.pose.pose()), SCENARIO) is None
    with pytest.raises(PolicyError, match="expected a policy with a method `decide`, got dict"):
        make_policy("my_push_policy:wrong")
    with pytest.raises(PolicyError, match="Expected module:factory that can be imported, got 'my_push_policy:none'"):
        make_policy("my_push_policy:none")


@pytest.mark.parametrize("name", shipped_policies())
def test_a_shipped_policy_works_and_is_small(name: str) -> None:
    policy = load_learned(name)

    push = policy.decide(make_state(SCENARIO.start.pose(), SCENARIO.box.pose.pose()), SCENARIO)

    assert push is not None
    assert policy.card.check is not None
    # Pushes that are all 5 cm deep turn the box by 4° each: what is left of that at the end is chance.
    least = {"variable": 0.95, "fixed": 0.6}[policy.card.task.entry]
    assert policy.card.check.success_rate >= least
    assert policy.card.check.position_error_m <= 0.015
    assert policy.card.check.falls == 0
