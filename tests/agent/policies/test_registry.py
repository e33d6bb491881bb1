"""Policies by name."""

import os
import shutil
import sys
from pathlib import Path

import pytest

from agent_proc.frames.push_view import push_view
from agent_proc.policies.digest import policy_sha256
from agent_proc.policies.folder import policy_path, shipped_policies
from agent_proc.policies.learned import LearnedPolicy
from agent_proc.policies.registry import make_policy, policy_from_data
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.errors import PolicyError
from legpush.messages.stepping import Push
from tests.agent.fake_world import make_state, scenario_at_station

SCENARIO = scenario_at_station()
VIEW = push_view(make_state(SCENARIO.start.pose(), SCENARIO.box.pose.pose(), tick=40), SCENARIO)
OWN = """
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.messages.stepping import Push

class OfWorld:
    def decide(self, world, scenario):
        return Push(w1=0.5, w2=0.5, leg="FL", depth_m=world.tick / 1000 + scenario.goal.position_tolerance_m)

class Confused:
    def decide(self, first, second, third):
        return None

make = OfWorld
scripted = ScriptedPolicy
confused = Confused
wrong = dict
"""


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A module of the user's in the working directory."""
    (tmp_path / "my_push_policy.py").write_text(OWN, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "my_push_policy", raising=False)


def test_the_scripted_and_the_shipped_policies_have_names() -> None:
    assert isinstance(make_policy("scripted"), ScriptedPolicy)
    assert shipped_policies() == ("fixed", "variable", "wide")
    for name in shipped_policies():
        policy = make_policy(name)
        assert isinstance(policy, LearnedPolicy)
        assert policy.card.task.entry == ("fixed" if name == "fixed" else "variable")


def test_an_unknown_policy_is_refused_with_the_valid_names() -> None:
    with pytest.raises(
        PolicyError, match=r"a policy \(dynamic_programming, .*wide\) or the folder of one, got 'nobody'"
    ):
        make_policy("nobody")


def test_a_normalizer_without_a_model_file_is_refused() -> None:
    with pytest.raises(PolicyError, match=r"Expected a model file \(.zip\) with --normalizer, got 'variable'"):
        make_policy("variable", Path("normalizer.pkl"))


def test_a_policy_of_ones_own_is_asked_about_world_and_scenario() -> None:
    push = make_policy("my_push_policy:make").decide(VIEW)

    assert push == Push(w1=0.5, w2=0.5, leg="FL", depth_m=40 / 1000 + 0.03)


def test_a_policy_of_ones_own_may_be_one_that_is_asked_about_a_view() -> None:
    assert make_policy("my_push_policy:scripted").decide(VIEW) == ScriptedPolicy().decide(VIEW) is not None


@pytest.mark.parametrize(
    ("factory", "message"),
    [
        ("wrong", r"my_push_policy:wrong: expected a policy with a method `decide\(world, scenario\)`, got dict"),
        ("confused", r"expected a policy with a method `decide\(world, scenario\)`, got Confused"),
        ("none", "Expected module:factory that can be imported, got 'my_push_policy:none'"),
    ],
)
def test_what_is_no_policy_is_refused(factory: str, message: str) -> None:
    with pytest.raises(PolicyError, match=message):
        make_policy(f"my_push_policy:{factory}")


def test_data_names_policies_of_this_package_and_folders_with_their_hash(tmp_path: Path) -> None:
    shutil.copytree(policy_path("fixed"), tmp_path / "folder")
    sha256 = policy_sha256("fixed")

    assert isinstance(policy_from_data("scripted", ""), ScriptedPolicy)
    for name in ("fixed", str(tmp_path / "folder")):
        assert isinstance(policy_from_data(name, sha256), LearnedPolicy)
        with pytest.raises(PolicyError, match=r"of the recording, SHA-256 0000000000000000\.\.\., got one with"):
            policy_from_data(name, "0" * 64)
        with pytest.raises(PolicyError, match=r"Expected the policy .* of the recording"):
            policy_from_data(name, "")


def test_data_names_no_code_unless_it_is_repeated() -> None:
    with pytest.raises(PolicyError, match="which runs code: repeat it with --policy my_push_policy:make"):
        policy_from_data("my_push_policy:make", policy_sha256("my_push_policy:make"))
    assert "my_push_policy" not in sys.modules
    assert os.getcwd() not in sys.path

    repeated = policy_from_data("my_push_policy:make", "", repeated="my_push_policy:make")
    assert repeated.decide(VIEW) is not None


def test_a_recorded_folder_of_the_earlier_format_needs_the_version_that_made_the_recording() -> None:
    old = Path(__file__).parents[2] / "compatibility" / "policies" / "tuned"

    with pytest.raises(PolicyError, match="format 1, which this version only converts: use the one that recorded it"):
        policy_from_data(str(old), "0" * 64)
